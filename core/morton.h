#pragma once
#include <cstdint>

namespace strata {

/// Spreads the low 21 bits so that two zero bits lie above each.
constexpr std::uint64_t spreadBits(std::uint64_t v) {
  v &= 0x1fffff;
  v = (v | v << 32) & 0x001f00000000ffff;
  v = (v | v << 16) & 0x001f0000ff0000ff;
  v = (v | v << 8) & 0x100f00f00f00f00f;
  v = (v | v << 4) & 0x10c30c30c30c30c3;
  v = (v | v << 2) & 0x1249249249249249;
  return v;
}

/// The Morton code of three 21-bit integers, with x in the highest bit of each triple as in NodeKey.
constexpr std::uint64_t mortonCode(std::uint64_t x, std::uint64_t y, std::uint64_t z) {
  return spreadBits(x) << 2 | spreadBits(y) << 1 | spreadBits(z);
}

}  // namespace strata
