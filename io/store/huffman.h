#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace strata {

/// A canonical order-0 Huffman code of bytes (Huffman 1952) without codes longer than 11 bits. The values are spread
/// over four bit streams, so that a decoder has four independent chains of look-ups.
///
/// Stored are a u8, the last symbol; the code lengths of the symbols up to it, 4 bits each, the low half of a byte
/// first; three u32, the bytes of streams 0 to 2 (the fourth takes the rest); and the streams. Value i is in stream i %
/// 4, and bits are filled from the least significant up.
class HuffmanCode {
 public:
  static constexpr int kMostBits = 11;
  using Histogram = std::array<std::uint32_t, 256>;

  /// Finds the best code for values that occur this often. At least two values must occur.
  explicit HuffmanCode(const Histogram& counts);

  /// The bytes that append() takes for values with these counts, up to 3 too many since each stream is rounded up.
  std::size_t storedBytes() const { return headBytes() + (payloadBits_ + 7) / 8 + 3; }
  /// Appends the code and the values, which must be those that were counted.
  void append(std::span<const std::uint8_t> values, std::vector<std::byte>& out) const;

 private:
  std::size_t headBytes() const { return 1 + (static_cast<std::size_t>(last_) + 2) / 2 + 12; }
  void assignCodes();

  std::array<std::uint8_t, 256> lengths_{};
  std::array<std::uint16_t, 256> codes_{};  ///< with their bits reversed, as they are written
  std::uint8_t last_ = 0;
  std::size_t payloadBits_ = 0;
};

/// Decodes out.size() values. False when the bytes are no such code or too short.
bool decodeHuffman(std::span<const std::byte> stored, std::span<std::uint8_t> out);

}  // namespace strata
