#include "render/flood/flood_fill.h"

#include <algorithm>

#include "render/flood/flood_search.h"
#include "render/flood/flood_splats.h"
#include "render/stopwatch.h"

namespace strata {

FloodStats floodFill(const RenderList& list, const View& view, const FloodSettings& settings, const ThreadPool& pool,
                     Picture& picture) {
  FloodStats stats;
  Stopwatch watch;
  const FloodSeeds seeds = collectSeeds(list, view, settings, picture, pool);
  stats.seeds = static_cast<std::uint32_t>(
      seeds.at.size() - static_cast<std::size_t>(std::count(seeds.at.begin(), seeds.at.end(), kNoPixel)));
  stats.projectMs = watch.lapMs();
  if (stats.seeds == 0) return stats;
  const std::vector<FloodLayers> layers = findLayers(seeds, settings, pool);
  stats.layersMs = watch.lapMs();
  const std::vector<FloodNeighbours> neighbours = findNeighbours(seeds, layers, settings, pool);
  stats.neighboursMs = watch.lapMs();
  const std::vector<FloodSplat> splats = makeSplats(seeds, neighbours, {picture.width, picture.height}, settings, pool);
  stats.splats = static_cast<std::uint32_t>(splats.size());
  stats.filled = drawSplats(splats, settings, pool, picture);
  stats.renderMs = watch.lapMs();
  return stats;
}

}  // namespace strata
