#pragma once
#include <cstdint>

#include "render/flood/flood_seeds.h"

namespace strata {

inline constexpr float kFloodDepthShare =
    0.01f;                                     ///< splats of one surface lie no farther behind, in shares of the depth
inline constexpr float kFloodOpenSide = 2.0f;  ///< how many times shorter a splat is on sides without a neighbour

inline constexpr float kFloodMostSpacings =
    2.5f;  ///< largest radius in spacings, where the median distance is below kFloodNextPixels
inline constexpr float kFloodSeedPixels = 2.0f;  ///< smallest distance of a neighbour that counts, pixels
inline constexpr float kFloodRound =
    1.5f;  ///< ratio of axes up to which a splat is a circle, because chance gives such
inline constexpr float kFloodMostStretch = 3.0f;  ///< largest ratio of the axes of an ellipse
inline constexpr int kFloodFewestNeighbours = 2;  ///< a point with fewer is an outlier
inline constexpr float kFloodLeastPixels = 0.5f;  ///< smallest radius, pixels
inline constexpr float kFloodFlat = 0.05f;        ///< second axis over first, below which neighbours form a line
inline constexpr float kFloodEdgeOn = 1e-3f;      ///< least |cosine| between the line of sight and the normal

/// A flat ellipse on the surface around a seed, as the picture shows it. With (dx, dy) from (x, y) to the middle of a
/// pixel:
///   n = 1 + tiltX dx + tiltY dy,  depth = (centreDepth + slopeX dx + slopeY dy) / n,
///   a = (acrossX dx + acrossY dy) / n,  b likewise with along,  d^2 = a^2 + b^2, which is 1 at the rim.
struct FloodSplat {
  float x, y;
  float tiltX, tiltY;
  float acrossX, acrossY, alongX, alongY;
  float centreDepth, slopeX, slopeY;
  float radius;                           ///< the longer one, metres
  FloodPixel from;                        ///< the seed
  std::uint32_t openSectors;              ///< a bit for each floodSector() without a neighbour; see kFloodOpenSide
  std::int16_t left, right, top, bottom;  ///< pixels [left, right] x [top, bottom] that it may touch
};

}  // namespace strata
