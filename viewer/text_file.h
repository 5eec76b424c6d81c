#pragma once
#include <string>
#include <string_view>

namespace strata {

/// The whole of a small text file. Throws Error when it cannot be read.
std::string readText(const std::string& path);
/// Replaces the file, whole or not at all: one that was there stays until then. Throws Error when it cannot be written
/// (`report.json: writing: No space left on device`).
void writeText(const std::string& path, std::string_view text);
/// Makes the folder and the ones above it. Throws Error when that fails.
void makeFolder(const std::string& path);

}  // namespace strata
