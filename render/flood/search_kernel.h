#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "render/flood/flood_neighbourhood.h"
#include "render/flood/flood_vectors.h"

namespace strata {

// The inner loops of jump flooding, by the best instruction set of the machine.

/// FloodLayers while they are searched, plane by plane. Rows have a margin to both sides that holds none, so that jumps
/// need not ask whether they leave the picture.
struct LayerArrays {
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * stride + static_cast<std::size_t>(margin + x);
  }

  std::size_t stride;
  int margin;
  std::vector<FloodPixel> layers[kFloodLayers];
};

/// One round of the layer search.
struct LayerRound {
  const FloodSeeds& seeds;
  const FloodSettings& settings;
  const LayerArrays& from;
  LayerArrays& to;
  int step;
};
/// Pixels [x, x + kFloodTile) of row y look at the eight pixels `step` away.
void searchLayers(const LayerRound& round, int x, int y);

/// out[i] = squared metres from `seed` to others[i], infinite where that is none.
void distancesTo(const FloodSeeds& seeds, FloodPixel seed, const FloodNeighbours& others, float* out);

/// What a candidate must be to become a neighbour of `seed`: of its layer, and no farther away than what is there.
struct NeighbourBounds {
  FloodPixel seed;
  float leastPerPixel2;  ///< squared metres: a point that is a pixel away in the picture is at least so far
  float farthest2[kFloodNeighbours];  ///< squared metres by floodSector(); infinite where there is none yet
  FloodPixel held[kFloodNeighbours];  ///< by floodSector(); these are no candidates
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
