#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace strata {

/// Reads from `offset` of an open file until `bytes` is full or the file ends; returns how many there were. Throws
/// Error `PATH: DOING: why` when the system refuses.
std::size_t readAt(int descriptor, const std::string& path, std::uint64_t offset, std::span<std::byte> bytes,
                   const char* doing = "reading");

/// Writes all of `bytes`. Throws as readAt().
void writeAt(int descriptor, const std::string& path, std::uint64_t offset, std::span<const std::byte> bytes,
             const char* doing = "writing");

}  // namespace strata
