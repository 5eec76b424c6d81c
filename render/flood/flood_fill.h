#pragma once
#include "render/flood/flood_seeds.h"

namespace strata {

/// What filling did, and what each of its steps cost.
struct FloodStats {
  std::uint32_t seeds = 0, splats = 0;
  std::uint64_t filled = 0;  ///< pixels
  double projectMs = 0.0, layersMs = 0.0, neighboursMs = 0.0, renderMs = 0.0;
};

/// Fills holes by jump flooding (Farias 2014). In half the resolution, it takes the points that the picture shows,
/// finds the layers of surface around each pixel, then the neighbours of each point in its layer, and draws each point
/// as a splat that reaches to its neighbours. Pixels that are empty, or hidden by a splat, become the mean of the
/// splats in front; all others stay. docs/hole_filling.md lists our deviations from the paper. `picture` was drawn from
/// `list` as seen by `view`, and is not lit yet.
FloodStats floodFill(const RenderList& list, const View& view, const FloodSettings& settings, const ThreadPool& pool,
                     Picture& picture);

}  // namespace strata
