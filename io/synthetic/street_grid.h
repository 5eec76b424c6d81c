#pragma once
#include <glm/glm.hpp>

#include "io/synthetic/surface.h"

namespace strata::synthetic {

/// The city's streets cross at the multiples of kPitch from (0, 0). The square blocks between them are raised by a kerb
/// and have a pavement around them.
namespace city {
inline constexpr float kPitch = 72.0f;       ///< from street axis to street axis, metres
inline constexpr float kCarriageway = 9.0f;  ///< width between the kerbs
inline constexpr float kPavement = 3.0f;
inline constexpr float kKerb = 0.12f;
inline constexpr float kOutskirts = 45.0f;  ///< meadow around the outermost street axis
}  // namespace city

/// Asphalt with its markings at a position in the city.
Surface streetSurface(const glm::vec2& position);

}  // namespace strata::synthetic
