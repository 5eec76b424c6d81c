#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace strata {

/// One byte of every point, in stored order: what planes other than bit-packed positions are made of.
/// Stored: u8 ColumnMode, u24 bytes that follow.
enum class ColumnMode : std::uint8_t {
  constant = 0,  ///< the byte that all have
  raw = 1,
  huffman = 2,  ///< huffman.h
  lz4 = 3,      ///< one LZ4 block
};

inline constexpr std::size_t kColumnHeadBytes = 4;
/// Lengths have 24 bits.
inline constexpr std::size_t kLongestColumn = (std::size_t{1} << 24) - 1;

/// Appends the column in the smallest of the modes (LZ4 is tried only where few bits a value let it win).
void appendColumn(std::span<const std::uint8_t> values, std::vector<std::byte>& out);

/// Decodes the column at the front of `stored` and moves `stored` behind it. False when the bytes are no such column.
bool takeColumn(std::span<const std::byte>& stored, std::span<std::uint8_t> out);

/// Entropy in bits of values of the sample (order 0).
double entropyBits(std::span<const std::uint8_t> values);

}  // namespace strata
