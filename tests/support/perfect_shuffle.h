#pragma once
#include <bit>
#include <cstdint>

namespace strata::test {

/// Rumpler's shuffle, which the keyed one is measured against: index i goes to place size / 2 * (i mod 2) + i / 2, as
/// often as `iterations` says (Rumpler 2019, eq. 3.2). It is a bijection for even sizes only.
constexpr std::uint32_t perfectShuffle(std::uint32_t i, std::uint32_t size, int iterations) {
  for (int k = 0; k < iterations; ++k) i = (i & 1u) * (size / 2) + i / 2;
  return i;
}

/// How often Rumpler 2019 (3.2) shuffles: half the binary logarithm of the size, rounded down. More iterations bring
/// the order back.
constexpr int perfectShuffles(std::uint32_t size) { return size == 0 ? 0 : (std::bit_width(size) - 1) / 2; }

}  // namespace strata::test
