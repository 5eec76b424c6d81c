#pragma once
#include <cstdint>

#include "render/flood/flood_seeds.h"

namespace strata {

inline constexpr float kFloodDepthShare = 0.01f;  ///< of the depth: what is no farther behind is one surface
inline constexpr float kFloodOpenSide = 2.0f;     ///< how much shorter a splat is towards where it has no neighbours

inline constexpr float kFloodMostSpacings =
    2.5f;  ///< largest radius in spacings where medians are below kFloodNextPixels
inline constexpr float kFloodSeedPixels = 2.0f;   ///< between seeds: closer ones are no closer
inline constexpr float kFloodRound = 1.5f;        ///< ratio of axes up to which a splat is a circle: chance makes such
inline constexpr float kFloodMostStretch = 3.0f;  ///< of an ellipse
inline constexpr int kFloodFewestNeighbours = 2;  ///< fewer are an outlier
inline constexpr float kFloodLeastPixels = 0.5f;  ///< radius
inline constexpr float kFloodFlat = 0.05f;        ///< second axis over the first, below which neighbours are a line
inline constexpr float kFloodEdgeOn = 1e-3f;      ///< least |cosine| between the line of sight and the normal

/// A flat ellipse on the surface around a seed, as the picture sees it: with (dx, dy) a pixel's middle less (x, y),
///   n = 1 + tiltX dx + tiltY dy,  depth = (centreDepth + slopeX dx + slopeY dy) / n,
///   a = (acrossX dx + acrossY dy) / n,  b likewise with along,  d^2 = a^2 + b^2, which is 1 at the rim.
struct FloodSplat {
  float x, y;
  float tiltX, tiltY;
  float acrossX, acrossY, alongX, alongY;
  float centreDepth, slopeX, slopeY;
  float radius;                           ///< metres; the longer one
  FloodPixel from;                        ///< the seed
  std::uint32_t openSectors;              ///< a bit for each floodSector() without a neighbour: half as far there
  std::int16_t left, right, top, bottom;  ///< pixels [left, right] x [top, bottom] that it may touch
};

}  // namespace strata
