#pragma once
#include <cstddef>
#include <cstdint>

#include "render/flood/flood_splat.h"
#include "render/flood/flood_vectors.h"

namespace strata {

// The inner loops of flood_splats.cpp. They run on the best instruction set of the machine.

/// Some rows of the picture while splats are drawn. A row takes `stride` values, at least width + kFloodTile.
struct FloodStrip {
  int top, bottom;  ///< rows [top, bottom)
  std::size_t stride;
  float* limit;                                ///< depth up to which splats count; infinite at first
  float *red, *green, *blue, *depth, *weight;  ///< weighted sums
  float* heaviest;                             ///< largest weight
  FloodPixel* from;                            ///< the seed whose splat had the largest weight
};
/// Lowers `limit` in the pixels of the splat to just behind it.
void drawSplatDepth(const FloodSplat& splat, const FloodStrip& strip);
/// Adds `colour` (R | G<<8 | B<<16) by the weight exp(-d^2) to the pixels in which the splat lies within the limit.
void blendSplat(const FloodSplat& splat, std::uint32_t colour, const FloodStrip& strip);

}  // namespace strata
