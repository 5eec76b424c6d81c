#pragma once
#include <vector>

#include "render/flood/flood_neighbourhood.h"
#include "render/flood/flood_seeds.h"

namespace strata {

/// True when two seeds belong to one surface (Farias 2014, 4.2): they are closer than the smaller of their reaches and,
/// where both have normals, the normals are alike and neither point lies far off the other's plane. The order of the
/// two makes no difference.
bool sameLayer(const FloodSeeds& seeds, FloodPixel a, FloodPixel b, const FloodSettings& settings);

/// The second step (4.2) finds, for each pixel of the half picture, the seeds of up to four layers that are closest to
/// it in the picture and have it in their reach. It jumps to the eight sides, by settings.firstStep pixels and then by
/// halves of that; jumps that are longer than any reach nearby are skipped. The result does not depend on the number of
/// threads.
std::vector<FloodLayers> findLayers(const FloodSeeds& seeds, const FloodSettings& settings, const ThreadPool& pool);

/// The third step (4.3) finds the closest points of each seed, in metres. Candidates are the layers at the places that
/// the seed's jumps reach, and the neighbours of the seeds there. Jumps longer than the seed's reach are skipped. The
/// result has one entry per seed, by FloodSeeds::index().
std::vector<FloodNeighbours> findNeighbours(const FloodSeeds& seeds, const std::vector<FloodLayers>& layers,
                                            const FloodSettings& settings, const ThreadPool& pool);

}  // namespace strata
