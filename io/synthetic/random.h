#pragma once
#include <cmath>
#include <cstdint>

#include "core/random.h"

namespace strata::synthetic {

/// Random numbers that depend on (key, index) alone, so that any point can be made without the ones before it.
class CounterRandom {
 public:
  CounterRandom(std::uint64_t key, std::uint64_t index) : state_(mix64(key + mix64((index + 1) * kSplitMixStep))) {}

  std::uint64_t bits() {
    state_ += kSplitMixStep;
    return mix64(state_);
  }
  /// In [0, 1).
  double uniform() { return unitInterval(bits()); }
  /// In [0, 1).
  float uniformFloat() { return static_cast<float>(bits() >> 40) * 0x1p-24f; }
  float between(float low, float high) { return low + (high - low) * uniformFloat(); }
  int below(int count) { return static_cast<int>((bits() >> 33) % static_cast<std::uint64_t>(count)); }
  bool chance(float probability) { return uniformFloat() < probability; }
  /// The sum of four uniform numbers: bell-shaped with mean 0 and variance 1, and never beyond 3.5.
  float bell() {
    const std::uint64_t b = bits();
    const std::uint64_t sum = (b & 0xffff) + (b >> 16 & 0xffff) + (b >> 32 & 0xffff) + (b >> 48);
    return (static_cast<float>(sum) * (1.0f / 65536.0f) - 2.0f) * 1.7320508f;
  }

 private:
  std::uint64_t state_;
};

/// A number in [0, 1) for one cell of a texture.
inline float cellHash(int x, int y, std::uint32_t seed) {
  std::uint32_t h =
      static_cast<std::uint32_t>(x) * 0x85ebca6bU ^ static_cast<std::uint32_t>(y) * 0xc2b2ae35U ^ seed * 0x27d4eb2fU;
  h = (h ^ (h >> 15)) * 0x2c1b3c6dU;
  h = (h ^ (h >> 12)) * 0x297a2d39U;
  return static_cast<float>((h ^ (h >> 15)) >> 8) * 0x1p-24f;
}

/// Smooth noise in [0, 1) with features of unit size, and its slope.
struct NoiseValue {
  float value, dx, dy;
};
inline NoiseValue valueNoise(float x, float y, std::uint32_t seed) {
  const float fx = std::floor(x), fy = std::floor(y);
  const int ix = static_cast<int>(fx), iy = static_cast<int>(fy);
  const float u = x - fx, v = y - fy;
  const float su = u * u * (3.0f - 2.0f * u), sv = v * v * (3.0f - 2.0f * v);
  const float a = cellHash(ix, iy, seed), b = cellHash(ix + 1, iy, seed);
  const float c = cellHash(ix, iy + 1, seed), d = cellHash(ix + 1, iy + 1, seed);
  const float mixed = a - b - c + d;
  return {a + (b - a) * su + (c - a) * sv + mixed * su * sv, 6.0f * u * (1.0f - u) * (b - a + mixed * sv),
          6.0f * v * (1.0f - v) * (c - a + mixed * su)};
}

}  // namespace strata::synthetic
