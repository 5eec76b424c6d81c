#include "render/flood_fill.h"

#include "render/flood_splats.h"
#include "render/stopwatch.h"

namespace strata {

FloodStats floodFill(const RenderList& list, const View& view, const FloodSettings& settings, const ThreadPool& pool,
                     Frame& frame) {
  FloodStats stats;
  Stopwatch watch;
  const FloodSeeds seeds = collectSeeds(list, view, settings, frame, pool);
  const int firstStep = firstFloodStep(seeds, settings);
  stats.seeds = static_cast<std::uint32_t>(seeds.seeds.size());
  stats.projectMs = watch.lapMs();
  const std::vector<FloodLayers> layers = findLayers(seeds, firstStep, settings, pool);
  stats.layersMs = watch.lapMs();
  const std::vector<FloodNeighbours> neighbours = findNeighbours(seeds, layers, firstStep, settings, pool);
  stats.neighboursMs = watch.lapMs();
  const std::vector<FloodSplat> splats = makeSplats(seeds, neighbours, view, settings, pool);
  stats.splats = static_cast<std::uint32_t>(splats.size());
  stats.filled = drawSplats(splats, view, settings, pool, frame);
  stats.renderMs = watch.lapMs();
  return stats;
}

}  // namespace strata
