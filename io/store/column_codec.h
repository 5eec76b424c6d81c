#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace strata {

/// A column is one byte of every point, in stored order. All planes except for bit-packed positions are made of
/// columns. Stored are a u8 ColumnMode, a u24 length in bytes, and that many bytes.
enum class ColumnMode : std::uint8_t {
  constant = 0,  ///< one byte, which all points have
  raw = 1,
  huffman = 2,  ///< huffman.h
  lz4 = 3,      ///< one LZ4 block
};

inline constexpr std::size_t kColumnHeadBytes = 4;
/// The longest column, since its length has 24 bits.
inline constexpr std::size_t kLongestColumn = (std::size_t{1} << 24) - 1;

/// Appends the column in the mode that takes the fewest bytes. LZ4 is tried only when Huffman codes are so short that
/// repeats may beat them.
void appendColumn(std::span<const std::uint8_t> values, std::vector<std::byte>& out);

/// Takes the column off the front of `stored` and decodes it; false when the bytes are no such column.
bool takeColumn(std::span<const std::byte>& stored, std::span<std::uint8_t> out);

/// The order-0 entropy of all values together, in bits.
double entropyBits(std::span<const std::uint8_t> values);

}  // namespace strata
