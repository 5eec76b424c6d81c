#pragma once
#include <cstddef>
#include <string>
#include <string_view>

namespace strata {

/// The whole of a small text file. Throws Error when it cannot be read or has more than `mostBytes`.
std::string readText(const std::string& path, std::size_t mostBytes = std::size_t{1} << 30);
/// Replaces the file, whole or not at all: one that was there stays until then. Throws Error when it cannot be written
/// (`report.json: writing: No space left on device`).
void writeText(const std::string& path, std::string_view text);
/// Makes the folder and the ones above it. Throws Error when that fails.
void makeFolder(const std::string& path);

}  // namespace strata
