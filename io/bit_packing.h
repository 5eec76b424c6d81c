#pragma once
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

namespace strata {

static_assert(std::endian::native == std::endian::little, "stores are little-endian and read in place");

/// Appends fields of 0 to 57 bits, least significant bit first.
class BitWriter {
 public:
  explicit BitWriter(std::vector<std::byte>& out) : out_(out) {}
  void put(std::uint64_t value, int bits) {
    pending_ |= value << pendingBits_;
    pendingBits_ += bits;
    if (pendingBits_ >= 64) spill(value, bits);
  }
  /// Pads with zeros to a whole byte.
  void flush() {
    const auto bytes = static_cast<std::size_t>(pendingBits_ + 7) / 8;
    append(bytes);
    pending_ = 0;
    pendingBits_ = 0;
  }

 private:
  void spill(std::uint64_t value, int bits) {
    append(8);
    pendingBits_ -= 64;
    pending_ = pendingBits_ == 0 ? 0 : value >> (bits - pendingBits_);
  }
  void append(std::size_t bytes) {
    const std::size_t at = out_.size();
    out_.resize(at + bytes);
    std::memcpy(out_.data() + at, &pending_, bytes);
  }

  std::vector<std::byte>& out_;
  std::uint64_t pending_ = 0;
  int pendingBits_ = 0;
};

/// Reads fields of 0 to 57 bits. The caller guarantees 8 readable bytes behind the last field.
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
