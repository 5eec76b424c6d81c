#pragma once
#include <vector>

#include "render/flood/flood_neighbourhood.h"
#include "render/flood/flood_splat.h"

namespace strata {

/// The fourth step's first half (Farias 2014, 4.4): the shape of each splat, from the median of the neighbours'
/// distances. Left out are those without a radius, with one over the seed's reach or over relativeRadius times the
/// closest neighbour's distance, and those that cover no more than their own pixel. `width` x `height`: the picture.
std::vector<FloodSplat> makeSplats(const FloodSeeds& seeds, const std::vector<FloodNeighbours>& neighbours,
                                   const glm::ivec2& size, const FloodSettings& settings, const ThreadPool& pool);

/// Its second half: the splats' depths, then the blend, by weight exp(-d^2), of those at the front of each pixel, into
/// the pixels that are empty or hidden by splats. A filled pixel's id is that of its heaviest splat. The same for any
/// number of threads. Returns how many pixels were filled.
std::uint64_t drawSplats(const std::vector<FloodSplat>& splats, const FloodSettings& settings, const ThreadPool& pool,
                         Picture& picture);

}  // namespace strata
