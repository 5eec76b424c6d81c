#pragma once
#include <cstdint>

namespace strata {

/// The step by which the state of SplitMix64 grows from one number to the next: 2^64 divided by the golden ratio.
inline constexpr std::uint64_t kSplitMixStep = 0x9e3779b97f4a7c15u;

/// The finaliser of SplitMix64 (Steele, Lea, Flood 2014): a bijection that spreads every input bit over all others.
constexpr std::uint64_t mix64(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/// The first number of the SplitMix64 sequence whose state begins at `index`. Neighbouring indices give independent
/// numbers, so that any of them can be had without the ones before it.
constexpr std::uint64_t splitMix64(std::uint64_t index) { return mix64(index + kSplitMixStep); }

/// The upper 53 bits of `bits` as a number in [0, 1).
constexpr double unitInterval(std::uint64_t bits) { return static_cast<double>(bits >> 11) * 0x1p-53; }

}  // namespace strata
