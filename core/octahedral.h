#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>

namespace strata {

/// A unit vector in two bytes: the octahedron is unfolded onto a square (Meyer et al. 2010, "On floating-point normal
/// vectors"), whose axes have 255 steps each, with zero at 127. The error is at most 1 degree; the six axes are exact.
using Octahedral = std::array<std::uint8_t, 2>;

inline glm::vec3 decodeOctahedral(Octahedral code) {
  glm::vec3 n((static_cast<float>(code[0]) - 127.0f) / 127.0f, (static_cast<float>(code[1]) - 127.0f) / 127.0f, 0.0f);
  n.z = 1.0f - std::abs(n.x) - std::abs(n.y);
  if (n.z < 0.0f) {
    const glm::vec2 flat(n);
    n.x = std::copysign(1.0f - std::abs(flat.y), flat.x);
    n.y = std::copysign(1.0f - std::abs(flat.x), flat.y);
  }
  return glm::normalize(n);
}

/// Encodes a vector of any length above 0: takes the one of the four codes around the mapped point that decodes
/// nearest.
inline Octahedral encodeOctahedral(const glm::dvec3& normal) {
  const glm::dvec3 n = normal / (std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z));
  glm::dvec2 square(n);
  if (n.z < 0.0) square = {std::copysign(1.0 - std::abs(n.y), n.x), std::copysign(1.0 - std::abs(n.x), n.y)};
  const glm::dvec2 low = glm::floor(square * 127.0 + 127.0);
  Octahedral best{127, 127};
  double bestCosine = -2.0;
  for (int corner = 0; corner < 4; ++corner) {
    const glm::dvec2 at = glm::clamp(low + glm::dvec2(corner & 1, corner >> 1), 0.0, 254.0);
    const Octahedral code{static_cast<std::uint8_t>(at.x), static_cast<std::uint8_t>(at.y)};
    const double cosine = glm::dot(glm::dvec3(decodeOctahedral(code)), glm::normalize(normal));
    if (cosine > bestCosine) {
      bestCosine = cosine;
      best = code;
    }
  }
  return best;
}

}  // namespace strata
