#pragma once
#include <array>

#include "render/flood/flood_seeds.h"

namespace strata {

inline constexpr int kFloodLayers = 4;      ///< Farias 2014, 4.2
inline constexpr int kFloodNeighbours = 8;  ///< the eighths of a circle; of the closest, the first four

/// Up to four seeds of one pixel of the half picture; kNoPixel behind the last.
using FloodLayers = std::array<FloodPixel, kFloodLayers>;

/// The neighbours of a seed: with FloodSettings::sectors by floodSector(), else by distance. kNoPixel: there is none.
using FloodNeighbours = std::array<FloodPixel, kFloodNeighbours>;

/// Which eighth of the circle around the origin (x, y) lies in, 0 to 7; y points down. Not for (0, 0).
inline int floodSector(float x, float y) {
  const bool left = x < 0.0f, up = y < 0.0f;
  const bool steep = (left ? -x : x) < (up ? -y : y);
  return (up ? 4 : 0) | (left ? 2 : 0) | (steep ? 1 : 0);
}

}  // namespace strata
