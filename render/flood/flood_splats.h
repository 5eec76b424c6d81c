#pragma once
#include <vector>

#include "render/flood/flood_neighbourhood.h"
#include "render/flood/flood_splat.h"

namespace strata {

/// The first half of the fourth step (Farias 2014, 4.4) shapes the splats. A radius is the median of the neighbours'
/// distances. A seed gets no splat where the radius is unknown, exceeds the seed's reach or relativeRadius times the
/// distance of the closest neighbour, or covers no more than the seed's own pixel. `size`: width and height of the
/// picture.
std::vector<FloodSplat> makeSplats(const FloodSeeds& seeds, const std::vector<FloodNeighbours>& neighbours,
                                   const glm::ivec2& size, const FloodSettings& settings, const ThreadPool& pool);

/// The second half draws the depths of the splats, then blends those at the front of each pixel, by the weight
/// exp(-d^2), into the pixels that are empty or hidden by splats. A filled pixel has the id of its heaviest splat. The
/// result does not depend on the number of threads. Returns how many pixels were filled.
std::uint64_t drawSplats(const std::vector<FloodSplat>& splats, const FloodSettings& settings, const ThreadPool& pool,
                         Picture& picture);

}  // namespace strata
