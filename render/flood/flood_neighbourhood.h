#pragma once
#include <array>

#include "render/flood/flood_seeds.h"

namespace strata {

inline constexpr int kFloodLayers = 4;      ///< Farias 2014, 4.2
inline constexpr int kFloodNeighbours = 8;  ///< one per eighth of the circle; without sectors only four are used

/// The closest seeds of up to four layers, for one pixel of the half picture; kNoPixel behind the last.
using FloodLayers = std::array<FloodPixel, kFloodLayers>;

/// The neighbours of a seed, in the order of floodSector() with FloodSettings::sectors, else by distance. kNoPixel
/// means that there is none.
using FloodNeighbours = std::array<FloodPixel, kFloodNeighbours>;

/// The eighth of the circle around the origin that (x, y) lies in, 0 to 7. y points down, and (x, y) is not (0, 0).
inline int floodSector(float x, float y) {
  const bool left = x < 0.0f, up = y < 0.0f;
  const bool steep = (left ? -x : x) < (up ? -y : y);
  return (up ? 4 : 0) | (left ? 2 : 0) | (steep ? 1 : 0);
}

}  // namespace strata
