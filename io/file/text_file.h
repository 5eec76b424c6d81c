#pragma once
#include <cstddef>
#include <string>
#include <string_view>

namespace strata {

/// Reads a small text file. Throws Error when it cannot be read or has more than `mostBytes` bytes.
std::string readText(const std::string& path, std::size_t mostBytes = std::size_t{1} << 30);
/// Writes a text file. An older file of this name is replaced when the new one is complete, and stays when that fails.
/// Throws Error (`report.json: writing: No space left on device`).
void writeText(const std::string& path, std::string_view text);
/// Creates the folder and those above it that do not exist. Throws Error when that fails.
void makeFolder(const std::string& path);

}  // namespace strata
