#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <random>

namespace strata::test {

/// Random numbers and directions for property tests. A seed gives the same sequence in every run.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double in(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
  /// A unit vector; all directions are equally likely.
  glm::dvec3 direction() {
    while (true) {
      const glm::dvec3 d(in(-1, 1), in(-1, 1), in(-1, 1));
      const double length = glm::length(d);
      if (length > 0.1 && length < 1.0) return d / length;
    }
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace strata::test
