#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "render/flood/flood_neighbourhood.h"
#include "render/flood/flood_vectors.h"

namespace strata {

// The inner loops of flood_search.cpp. They run on the best instruction set of the machine.

/// The layers of all pixels while they are searched: layers[k] holds layer k of every pixel. Rows have a margin without
/// seeds on both sides, so that jumps to the side need no test.
struct LayerArrays {
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * stride + static_cast<std::size_t>(margin + x);
  }

  std::size_t stride;
  int margin;
  std::vector<FloodPixel> layers[kFloodLayers];
};

/// One round of the layer search, which reads `from` and writes `to`.
struct LayerRound {
  const FloodSeeds& seeds;
  const FloodSettings& settings;
  const LayerArrays& from;
  LayerArrays& to;
  int step;
};
/// Lets the pixels [x, x + kFloodTile) of row y look at the eight pixels that are round.step away.
void searchLayers(const LayerRound& round, int x, int y);

/// Sets out[i] to the squared distance of `seed` and others[i] in metres, infinite where there is no others[i].
void distancesTo(const FloodSeeds& seeds, FloodPixel seed, const FloodNeighbours& others, float* out);

/// The tests that a candidate must pass to become a neighbour of `seed`, besides belonging to its layer.
struct NeighbourBounds {
  FloodPixel seed;
  float leastPerPixel2;  ///< least squared distance of a point one pixel away in the picture, squared metres
  float farthest2[kFloodNeighbours];  ///< by floodSector(): squared metres; infinite where there is no neighbour yet
  FloodPixel held[kFloodNeighbours];  ///< by floodSector(): the neighbours so far, which are no candidates
};
/// Where keepClose() writes the candidates that it keeps. Both arrays have room for kFloodTile more.
struct CloseCandidates {
  FloodPixel* seeds;
  float* distance2;  ///< squared metres
};
/// Writes those of `candidates` that may become neighbours within `bounds`, and returns how many they are. Memory
/// behind the candidates must be readable for kFloodTile more.
std::size_t keepClose(const FloodSeeds& seeds, const FloodSettings& settings, const NeighbourBounds& bounds,
                      std::span<const FloodPixel> candidates, const CloseCandidates& kept);

}  // namespace strata
