#pragma once
#include <cstdint>

#include <glm/glm.hpp>

namespace strata::synthetic {

/// The light and the laser's echo that one point of a surface gives back.
struct Surface {
  glm::vec3 albedo{0.5f};
  float reflectance = 0.5f;  ///< for the laser, 0 to 1
  float glow = 0.0f;         ///< share of the albedo that shows without any light
  std::uint8_t classification = 1;
};

}  // namespace strata::synthetic
