#pragma once
#include <array>

#include "render/flood/flood_seeds.h"

namespace strata {

inline constexpr int kFloodLayers = 4;      ///< Farias 2014, 4.2
inline constexpr int kFloodNeighbours = 8;  ///< the eighths of a circle; of the closest, the first four

/// Up to four seeds of one pixel of the half picture; kNoPixel behind the last.
using FloodLayers = std::array<FloodPixel, kFloodLayers>;

/// The neighbours of a seed: with FloodSettings::sectors by floodSector(), else by distance. kNoPixel: there is none.
using FloodNeighbours = std::array<FloodPixel, kFloodNeighbours>;

/// Whether two seeds are of one surface (Farias 2014, 4.2): closer than the smaller of their reaches and, where both
/// have normals, these alike and neither point far from the other's plane. The same for (a, b) and (b, a).
bool sameLayer(const FloodSeeds& seeds, FloodPixel a, FloodPixel b, const FloodSettings& settings);

/// Which eighth of the circle around the origin (x, y) lies in, 0 to 7; y points down. Not for (0, 0).
inline int floodSector(float x, float y) {
  const bool left = x < 0.0f, up = y < 0.0f;
  const bool steep = (left ? -x : x) < (up ? -y : y);
  return (up ? 4 : 0) | (left ? 2 : 0) | (steep ? 1 : 0);
}

/// The second step (4.2): for each pixel of the half picture the seeds of up to four layers that are closest to it in
/// the picture, but within their reach, found by jumps to the eight sides of settings.firstStep and its halves; those
/// that are longer than any reach nearby are spared. The same for any number of threads.
std::vector<FloodLayers> findLayers(const FloodSeeds& seeds, const FloodSettings& settings, const ThreadPool& pool);

/// The third step (4.3): for each seed, by index(), the closest points, in metres, among the layers that its jumps meet
/// and the neighbours of the seeds there. Jumps longer than its reach are spared.
std::vector<FloodNeighbours> findNeighbours(const FloodSeeds& seeds, const std::vector<FloodLayers>& layers,
                                            const FloodSettings& settings, const ThreadPool& pool);

}  // namespace strata
