#pragma once
#include <array>

#include "render/flood_seeds.h"

namespace strata {

inline constexpr int kFloodLayers = 4;      ///< Farias 2014, 4.2
inline constexpr int kFloodNeighbours = 8;  ///< the eighths of a circle; of the closest, the first four

/// Indices of seeds; kNone behind the last.
using FloodLayers = std::array<std::uint32_t, kFloodLayers>;

/// The neighbours of a seed: with FloodSettings::sectors by floodSector(), else by distance. kNone where there is none.
using FloodNeighbours = std::array<std::uint32_t, kFloodNeighbours>;

/// Whether two points are of one surface (Farias 2014, 4.2): closer than the smaller of their reaches and, where both
/// have normals, these alike and neither point far from the other's plane. The same for (a, b) and (b, a).
bool sameLayer(const FloodSeed& a, const FloodSeed& b, const FloodSettings& settings);

/// Which eighth of the circle around the origin (x, y) lies in, 0 to 7; y points down. Not for (0, 0).
inline int floodSector(float x, float y) {
  const bool left = x < 0.0f, up = y < 0.0f;
  const bool steep = (left ? -x : x) < (up ? -y : y);
  return (up ? 4 : 0) | (left ? 2 : 0) | (steep ? 1 : 0);
}

/// The longest jump that is of use: a power of two, at most settings.firstStep, that reaches as far in the picture as
/// any seed's neighbours may be.
int firstFloodStep(const FloodSeeds& seeds, const FloodSettings& settings);

/// The second step (4.2): for each pixel of the half picture the seeds of up to four layers that are closest to it in
/// the picture, but within their reach, found by jumps of `firstStep` and its halves to the eight sides. The same for
/// any number of threads.
std::vector<FloodLayers> findLayers(const FloodSeeds& seeds, int firstStep, const FloodSettings& settings,
                                    const ThreadPool& pool);

/// The third step (4.3): for each seed the closest points, in metres, among the layers that its jumps meet and the
/// neighbours of the seeds there. Points at its own place do not count.
std::vector<FloodNeighbours> findNeighbours(const FloodSeeds& seeds, const std::vector<FloodLayers>& layers,
                                            int firstStep, const FloodSettings& settings, const ThreadPool& pool);

}  // namespace strata
