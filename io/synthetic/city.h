#pragma once
#include <cstdint>
#include <memory>

#include <glm/glm.hpp>

#include "io/synthetic/material.h"
#include "io/synthetic/shape.h"

namespace strata::synthetic {

/// The street grid: crossings at the multiples of kPitch from (0, 0), between them square blocks, each raised by a kerb
/// and rimmed by a pavement.
namespace city {
inline constexpr float kPitch = 72.0f;       ///< from street axis to street axis, metres
inline constexpr float kCarriageway = 9.0f;  ///< width between the kerbs
inline constexpr float kPavement = 3.0f;
inline constexpr float kKerb = 0.12f;
inline constexpr float kOutskirts = 45.0f;  ///< meadow around the outermost street axis
}  // namespace city

/// Asphalt with markings.
Surface streetSurface(const glm::vec2& position);

class ScannerScan;

/// A city around a square with a church, scanned from its crossings and from the air. It grows with the points:
/// 3 x 3 blocks for a million, 6 x 6 for a billion.
std::unique_ptr<ScannerScan> makeCity(std::uint64_t points, std::uint64_t seed);
/// An office floor: rooms on both sides of a corridor, two scanner positions in each. It grows with the points, from 4
/// to 20 rooms.
std::unique_ptr<ScannerScan> makeRoom(std::uint64_t points, std::uint64_t seed);

}  // namespace strata::synthetic
