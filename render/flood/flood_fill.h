#pragma once
#include "render/flood/flood_seeds.h"

namespace strata {

/// What filling did and what each of its steps cost.
struct FloodStats {
  std::uint32_t seeds = 0, splats = 0;
  std::uint64_t filled = 0;  ///< pixels
  double projectMs = 0.0, layersMs = 0.0, neighboursMs = 0.0, renderMs = 0.0;
};

/// Hole filling by jump flooding (Farias 2014): from the points that the frame shows, in half the resolution, the
/// layers of each pixel, then the neighbours of each point among them, then a splat for each point as large as its
/// neighbours are far away. Pixels that are empty, or hidden by a splat, take the mean of the splats in front; all
/// others stay as they are. What the paper does otherwise: docs/effects.md. `picture` was drawn from `list`, seen by
/// `view`; its colours are not lit yet.
FloodStats floodFill(const RenderList& list, const View& view, const FloodSettings& settings, const ThreadPool& pool,
                     Picture& picture);

}  // namespace strata
