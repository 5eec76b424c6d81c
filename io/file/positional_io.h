#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace strata {

/// pread() and pwrite() of whole ranges: both go on after a short transfer or a signal.

/// Reads from `offset` on until `bytes` is full or the file ends, and returns the number of bytes read. Throws Error
/// `PATH: DOING: why` when the system refuses.
std::size_t readAt(int descriptor, const std::string& path, std::uint64_t offset, std::span<std::byte> bytes,
                   const char* doing = "reading");

/// Writes `bytes` at `offset`. Throws as readAt().
void writeAt(int descriptor, const std::string& path, std::uint64_t offset, std::span<const std::byte> bytes,
             const char* doing = "writing");

}  // namespace strata
