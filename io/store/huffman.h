#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace strata {

/// Order-0 Huffman code of bytes (Huffman 1952), canonical, no code longer than 11 bits, in four interleaved bit
/// streams so that a decoder has four independent chains of look-ups.
///
/// Stored: u8 last symbol; code lengths of symbols 0 to last, 4 bits each, low half first; u32[3] bytes of streams 0
/// to 2 (the fourth takes the rest); the streams. Value i is in stream i % 4; bits from the least significant up.
class HuffmanCode {
 public:
  static constexpr int kMostBits = 11;
  using Histogram = std::array<std::uint32_t, 256>;

  /// The best code for values that occur this often; at least two must occur.
  explicit HuffmanCode(const Histogram& counts);

  /// Bytes that append() will take for values with these counts (exact but for rounding up of the streams).
  std::size_t storedBytes() const { return headBytes() + (payloadBits_ + 7) / 8 + 3; }
  void append(std::span<const std::uint8_t> values, std::vector<std::byte>& out) const;

 private:
  std::size_t headBytes() const { return 1 + (static_cast<std::size_t>(last_) + 2) / 2 + 12; }
  void assignCodes();

  std::array<std::uint8_t, 256> lengths_{};
  std::array<std::uint16_t, 256> codes_{};  ///< bits reversed, as they are written
  std::uint8_t last_ = 0;
  std::size_t payloadBits_ = 0;
};

/// Decodes exactly out.size() values. False when the bytes are no such code or too short.
bool decodeHuffman(std::span<const std::byte> stored, std::span<std::uint8_t> out);

}  // namespace strata
