#pragma once
#include <cstdint>

#include <glm/glm.hpp>

#include "io/synthetic/material.h"
#include "io/synthetic/surface.h"

namespace strata::synthetic {

/// Bits for the sides of a box that carry windows.
namespace side {
inline constexpr std::uint8_t kWest = 1, kEast = 2, kSouth = 4, kNorth = 8, kAll = 15;
}  // namespace side

/// The point where a ray that reached a facade ends: on the wall, on a pane behind it or on the side of an opening.
struct FacadeHit {
  Surface surface;
  glm::vec3 normal;
  float deeper = 0.0f;  ///< metres along the ray behind the wall's face
};

/// Follows a ray into the windows of a box, whose panes lie a few centimetres behind its walls. `point` is on the box.
FacadeHit hitFacade(const SurfacePoint& point, std::uint8_t windowSides, const glm::vec3& direction);

}  // namespace strata::synthetic
