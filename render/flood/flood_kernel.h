#pragma once
#include "render/flood/flood_search.h"
#include "render/flood/flood_splats.h"

namespace strata {

// The inner loops of jump flooding, by the best instruction set of the machine.

inline constexpr int kFloodTile = 16;  ///< pixels of a row that are searched at once: a multiple of any vector's

/// FloodLayers while they are searched, plane by plane. Rows have a margin to both sides that holds none, so that jumps
/// need not ask whether they leave the picture.
struct LayerPlanes {
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * stride + static_cast<std::size_t>(margin + x);
  }

  std::size_t stride;
  int margin;
  std::vector<FloodPixel> planes[kFloodLayers];
};

/// One round of the layer search.
struct LayerRound {
  const FloodSeeds& seeds;
  const FloodSettings& settings;
  const LayerPlanes& from;
  LayerPlanes& to;
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
/// Those of `count` candidates that may become neighbours, and how far away they are, squared. Each of the three arrays
/// has room for kFloodTile more. Returns how many.
std::size_t keepClose(const FloodSeeds& seeds, const FloodSettings& settings, const NeighbourBounds& bounds,
                      const FloodPixel* candidates, std::size_t count, FloodPixel* kept, float* distance2);

/// Some rows of the picture while splats are drawn. Rows are `stride` long, at least width + kFloodTile.
struct FloodStrip {
  int top, bottom;  ///< rows [top, bottom)
  std::size_t stride;
  float* limit;                                ///< how far away splats may be that count; first infinite
  float *red, *green, *blue, *depth, *weight;  ///< sums
  float* heaviest;                             ///< largest weight
  FloodPixel* from;                            ///< the seed that had it
};
/// Lowers `limit` to what the splat and what lies just behind it hide.
void drawSplatDepth(const FloodSplat& splat, const FloodStrip& strip);
/// Adds `colour` (R | G<<8 | B<<16), by the weight exp(-d^2), where the splat is within the limit.
void blendSplat(const FloodSplat& splat, std::uint32_t colour, const FloodStrip& strip);

}  // namespace strata
