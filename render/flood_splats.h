#pragma once
#include "render/flood_search.h"

namespace strata {

/// A flat ellipse on the surface around a seed.
struct FloodSplat {
  glm::vec3 centre;    ///< as FloodSeed::position
  std::uint32_t from;  ///< as FloodSeed::from
  glm::vec3 normal;
  float radius;               ///< metres; the longer one
  glm::vec3 across, along;    ///< in the plane; dot(offset, across)^2 + dot(offset, along)^2 is 1 at the rim
  std::uint32_t openSectors;  ///< a bit for each floodSector() of the picture without a neighbour: half as far there
};

/// The fourth step's first half (Farias 2014, 4.4): the shape of each splat, from the median of the neighbours'
/// distances. Left out are those without a radius, with one over the seed's reach or over relativeRadius times the
/// closest neighbour's distance, and those that cover no more than their own pixel.
std::vector<FloodSplat> makeSplats(const FloodSeeds& seeds, const std::vector<FloodNeighbours>& neighbours,
                                   const View& view, const FloodSettings& settings, const ThreadPool& pool);

/// Its second half: the splats' depths, then the blend, by weight exp(-d^2), of those at the front of each pixel, into
/// the pixels that are empty or hidden by splats. A filled pixel's id is that of its heaviest splat. The same for any
/// number of threads. Returns how many pixels were filled.
std::uint64_t drawSplats(const std::vector<FloodSplat>& splats, const View& view, const FloodSettings& settings,
                         const ThreadPool& pool, Frame& frame);

}  // namespace strata
