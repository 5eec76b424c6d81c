#pragma once
#include <vector>

#include "render/flood/flood_neighbourhood.h"
#include "render/flood/flood_seeds.h"

namespace strata {

/// Whether two seeds are of one surface (Farias 2014, 4.2): closer than the smaller of their reaches and, where both
/// have normals, these alike and neither point far from the other's plane. The same for (a, b) and (b, a).
bool sameLayer(const FloodSeeds& seeds, FloodPixel a, FloodPixel b, const FloodSettings& settings);

/// The second step (4.2): for each pixel of the half picture the seeds of up to four layers that are closest to it in
/// the picture, but within their reach, found by jumps to the eight sides of settings.firstStep and its halves; those
/// that are longer than any reach nearby are spared. The same for any number of threads.
std::vector<FloodLayers> findLayers(const FloodSeeds& seeds, const FloodSettings& settings, const ThreadPool& pool);

/// The third step (4.3): for each seed, by index(), the closest points, in metres, among the layers that its jumps meet
/// and the neighbours of the seeds there. Jumps longer than its reach are spared.
std::vector<FloodNeighbours> findNeighbours(const FloodSeeds& seeds, const std::vector<FloodLayers>& layers,
                                            const FloodSettings& settings, const ThreadPool& pool);

}  // namespace strata
