#pragma once
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace strata {

static_assert(std::endian::native == std::endian::little, "stores are little-endian and read in place");

/// Reading and writing touch up to this many bytes behind the last field, which must exist.
inline constexpr std::size_t kBitSlack = 8;

/// Writes fields of 0 to 57 bits, least significant bit first. The caller provides the room, and kBitSlack bytes behind
/// it.
class BitWriter {
 public:
  explicit BitWriter(std::byte* to) : to_(to) {}
  void put(std::uint64_t value, int bits) {
    window_ |= value << bits_;
    bits_ += bits;
    std::memcpy(to_, &window_, sizeof window_);
    const int whole = bits_ & ~7;
    to_ += whole >> 3;
    window_ = whole < 64 ? window_ >> whole : 0;
    bits_ &= 7;
  }
  /// Pads with zeros to a whole byte, and returns the place of the next one.
  std::byte* finish() {
    if (bits_ > 0) {
      *to_++ = static_cast<std::byte>(window_);
      window_ = 0;
      bits_ = 0;
    }
    return to_;
  }

 private:
  std::byte* to_;
  std::uint64_t window_ = 0;
  int bits_ = 0;
};

/// Reads fields of 0 to 57 bits. The caller provides kBitSlack readable bytes behind the last field.
class BitReader {
 public:
  explicit BitReader(const std::byte* data) : data_(data) {}
  std::uint64_t get(int bits) {
    std::uint64_t word;
    std::memcpy(&word, data_ + (at_ >> 3), sizeof word);
    word >>= at_ & 7;
    at_ += static_cast<std::size_t>(bits);
    return word & ((std::uint64_t{1} << bits) - 1);
  }

 private:
  const std::byte* data_;
  std::size_t at_ = 0;
};

}  // namespace strata
