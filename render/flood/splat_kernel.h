#pragma once
#include <cstddef>
#include <cstdint>

#include "render/flood/flood_splat.h"
#include "render/flood/flood_vectors.h"

namespace strata {

/// Some rows of the picture while splats are drawn. Rows are `stride` long, at least width + kFloodTile.
struct FloodStrip {
  int top, bottom;  ///< rows [top, bottom)
  std::size_t stride;
  float* limit;                                ///< how far away splats may be that count; first infinite
  float *red, *green, *blue, *depth, *weight;  ///< sums
  float* heaviest;                             ///< largest weight
  FloodPixel* from;                            ///< the seed that had it
};
/// Lowers `limit` to what the splat and what lies just behind it hide.
void drawSplatDepth(const FloodSplat& splat, const FloodStrip& strip);
/// Adds `colour` (R | G<<8 | B<<16), by the weight exp(-d^2), where the splat is within the limit.
void blendSplat(const FloodSplat& splat, std::uint32_t colour, const FloodStrip& strip);

}  // namespace strata
