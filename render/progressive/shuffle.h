#pragma once
#include <bit>
#include <cstdint>

namespace strata {

// The points of a pool lie shuffled: the point with index i of [0, size) lies at place shuffled(i). The shuffle is a
// bijection, so a range of indices, which the memory manager hands out, owns places all over the pool.

/// A bijection for any size, a different one for each key. It is a Feistel network over the smallest power of two that
/// holds the size, applied again until its result lies inside, less than twice on average (Black and Rogaway 2002,
/// "Ciphers with Arbitrary Finite Domains"). The halves differ by one bit where the power is odd. It need not be
/// secure.
class KeyedShuffle {
 public:
  KeyedShuffle(std::uint32_t size, std::uint32_t key) : size_(size), key_(key) {
    const int bits = size > 1 ? std::bit_width(size - 1) : 0;
    lowBits_ = bits / 2;
    lowMask_ = (1u << lowBits_) - 1u;
    highMask_ = (1u << (bits - lowBits_)) - 1u;
  }

  /// The place of index `i`, which is less than the size.
  std::uint32_t operator()(std::uint32_t i) const {
    do i = encipher(i);
    while (i >= size_);
    return i;
  }

 private:
  static constexpr std::uint32_t kRounds = 3;  ///< of two half rounds

  std::uint32_t encipher(std::uint32_t i) const {
    std::uint32_t low = i & lowMask_, high = i >> lowBits_;
    for (std::uint32_t round = 0; round < kRounds; ++round) {
      low ^= mixed(high, 2 * round) & lowMask_;
      high ^= mixed(low, 2 * round + 1) & highMask_;
    }
    return high << lowBits_ | low;
  }

  std::uint32_t mixed(std::uint32_t half, std::uint32_t round) const {
    std::uint32_t x = half + key_ + round * 0x9e3779b9u;
    x = (x ^ x >> 16) * 0x85ebca6bu;
    x = (x ^ x >> 13) * 0xc2b2ae35u;
    return x ^ x >> 16;
  }

  std::uint32_t size_, key_;
  int lowBits_ = 0;
  std::uint32_t lowMask_ = 0, highMask_ = 0;
};

}  // namespace strata
