#include "render/flood/flood_search.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/flood/search_kernel.h"

namespace strata {
namespace {

constexpr std::size_t kRowsAtOnce = 8;
constexpr std::size_t kClosest = 4;  ///< Farias 2014, 4.3
constexpr float kInfinite = std::numeric_limits<float>::infinity();

float distance2(const glm::vec3& a, const glm::vec3& b) { return glm::dot(b - a, b - a); }

/// Knows for each square of kFloodTile x kFloodTile pixels the largest reach, in pixels, of the seeds that reach into
/// it. Reaches end at `farthest`, which is as far as all jumps together go.
class NearbyReaches {
 public:
  NearbyReaches(const FloodSeeds& seeds, float farthest)
      : columns_((seeds.width + kFloodTile - 1) / kFloodTile), rows_((seeds.height + kFloodTile - 1) / kFloodTile) {
    std::vector<float> own(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), 0.0f);
    std::size_t i = 0;
    for (int y = 0; y < seeds.height; ++y)
      for (int x = 0; x < seeds.width; ++x, ++i)
        if (seeds.at[i] != kNoPixel) {
          float& largest = own[index(x / kFloodTile, y / kFloodTile)];
          largest = std::max(largest, std::min(seeds.reachPx(i), farthest));
        }
    reach_ = own;
    for (int row = 0; row < rows_; ++row)
      for (int column = 0; column < columns_; ++column) spread(own[index(column, row)], column, row);
  }

  float at(int x, int y) const { return reach_[index(x / kFloodTile, y / kFloodTile)]; }

 private:
  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
  }
  void spread(float reach, int column, int row) {
    if (!(reach > 0.0f)) return;
    const int tiles = static_cast<int>(reach) / kFloodTile + 1;
    for (int v = std::max(row - tiles, 0); v <= std::min(row + tiles, rows_ - 1); ++v)
      for (int u = std::max(column - tiles, 0); u <= std::min(column + tiles, columns_ - 1); ++u)
        reach_[index(u, v)] = std::max(reach_[index(u, v)], reach);
  }

  int columns_, rows_;
  std::vector<float> reach_;
};

// The two halves of sameLayer(). The first one rules most pairs out.
bool inReach(const FloodPoint& a, const FloodPoint& b, float distance2) {
  const float reach = std::min(a.reach, b.reach);
  return distance2 <= reach * reach;
}

bool alike(const FloodSeeds& seeds, FloodPixel a, FloodPixel b, const FloodSettings& settings) {
  constexpr glm::vec3 kUnknown(0.0f);
  if (seeds.normals.empty()) return true;
  const glm::vec3 normalA = unpackFloodNormal(seeds.normals[seeds.index(a)]);
  const glm::vec3 normalB = unpackFloodNormal(seeds.normals[seeds.index(b)]);
  if (normalA == kUnknown || normalB == kUnknown) return true;
  const glm::vec3 apart = seeds.position(b) - seeds.position(a);
  const float off = std::max(std::abs(glm::dot(apart, normalA)), std::abs(glm::dot(apart, normalB)));
  return std::abs(glm::dot(normalA, normalB)) >= settings.angle &&
         off < settings.continuity * std::min(seeds.points[seeds.index(a)].reach, seeds.points[seeds.index(b)].reach);
}

/// The least distance of two points whose pixels are one pixel apart, as a share of the size of a pixel at the depth of
/// the first. In perspective, the second point may be nearer to the eye along an oblique line of sight.
float leastShare(const FloodSeeds& seeds) {
  if (!seeds.lens.perspective) return 1.0f;
  const auto farther = [](float middle, int side) { return std::max(middle, static_cast<float>(2 * side) - middle); };
  const float x = seeds.lens.perPixel * farther(seeds.lens.middleX, seeds.width);
  const float y = seeds.lens.perPixel * farther(seeds.lens.middleY, seeds.height);
  return 1.0f / std::sqrt(1.0f + x * x + y * y);
}

/// The candidates of one seed, with the room behind them that keepClose() needs.
struct Candidates {
  static constexpr std::size_t kMost = 8 * (kFloodLayers + kFloodNeighbours);

  template <std::size_t n>
  void add(const std::array<FloodPixel, n>& some) {
    std::copy(some.begin(), some.end(), seeds + count);
    count += n;
  }

  FloodPixel seeds[kMost + kFloodTile];
  std::size_t count = 0;
};

/// Searches the neighbours of one seed. `found` holds those so far.
class NeighbourList {
 public:
  NeighbourList(const FloodSeeds& seeds, const FloodSettings& settings, float leastShare, FloodPixel seed,
                FloodNeighbours& found)
      : seeds_(seeds), settings_(settings), found_(found) {
    // A little less than the bound, so that rounding rules no candidate out.
    const float least = 0.999f * leastShare * seeds.lens.metres(seeds.points[seeds.index(seed)].depth);
    bounds_.seed = seed;
    bounds_.leastPerPixel2 = least * least;
    distancesTo(seeds, seed, found, distances_);
    std::copy_n(distances_, kFloodNeighbours, bounds_.farthest2);
    std::copy(found.begin(), found.end(), bounds_.held);
    if (settings.sectors) return;
    std::fill_n(bounds_.farthest2, kFloodNeighbours, distances_[kClosest - 1]);
    std::fill_n(bounds_.held, kFloodNeighbours, kNoPixel);
  }

  void consider(const Candidates& candidates) {
    FloodPixel kept[Candidates::kMost + kFloodTile];
    float distances[Candidates::kMost + kFloodTile];
    const std::size_t count =
        keepClose(seeds_, settings_, bounds_, {candidates.seeds, candidates.count}, {kept, distances});
    for (std::size_t i = 0; i < count; ++i)
      settings_.sectors ? considerInSector(kept[i], distances[i]) : considerOfAll(kept[i], distances[i]);
  }

 private:
  void considerInSector(FloodPixel candidate, float distance2) {
    const auto sector =
        static_cast<std::size_t>(floodSector(static_cast<float>(pixelColumn(candidate) - pixelColumn(bounds_.seed)),
                                             static_cast<float>(pixelRow(candidate) - pixelRow(bounds_.seed))));
    if (before(distance2, candidate, sector)) put(sector, candidate, distance2);
  }
  void considerOfAll(FloodPixel candidate, float distance2) {
    if (!before(distance2, candidate, kClosest - 1)) return;
    std::size_t at = 0;
    for (; at < kClosest && !before(distance2, candidate, at); ++at)
      if (found_[at] == candidate) return;
    for (std::size_t i = kClosest - 1; i > at; --i) put(i, found_[i - 1], distances_[i - 1]);
    put(at, candidate, distance2);
  }
  bool before(float distance2, FloodPixel candidate, std::size_t at) const {
    return distance2 < distances_[at] || (distance2 == distances_[at] && candidate < found_[at]);
  }
  void put(std::size_t i, FloodPixel candidate, float distance2) {
    found_[i] = candidate;
    distances_[i] = distance2;
  }

  const FloodSeeds& seeds_;
  const FloodSettings& settings_;
  FloodNeighbours& found_;
  float distances_[kFloodNeighbours];
  NeighbourBounds bounds_;
};

/// Calls visit(seed, index) for all seeds, on several threads.
template <typename Visit>
void forEachSeed(const FloodSeeds& seeds, const ThreadPool& pool, Visit visit) {
  const auto width = static_cast<std::size_t>(seeds.width);
  pool.parallelFor(static_cast<std::size_t>(seeds.height), kRowsAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin * width; i < end * width; ++i)
      if (seeds.at[i] != kNoPixel) visit(seeds.at[i], i);
  });
}

LayerArrays emptyArrays(const FloodSeeds& seeds, int firstStep) {
  LayerArrays out{};
  out.margin = firstStep + kFloodTile;
  out.stride = static_cast<std::size_t>(seeds.width + 2 * out.margin);
  for (std::vector<FloodPixel>& layer : out.layers)
    layer.assign(out.stride * static_cast<std::size_t>(seeds.height), kNoPixel);
  return out;
}

}  // namespace

bool sameLayer(const FloodSeeds& seeds, FloodPixel a, FloodPixel b, const FloodSettings& settings) {
  return inReach(seeds.points[seeds.index(a)], seeds.points[seeds.index(b)],
                 distance2(seeds.position(a), seeds.position(b))) &&
         alike(seeds, a, b, settings);
}

std::vector<FloodLayers> findLayers(const FloodSeeds& seeds, const FloodSettings& settings, const ThreadPool& pool) {
  LayerArrays from = emptyArrays(seeds, settings.firstStep), to = from;
  for (int y = 0; y < seeds.height; ++y)
    std::copy_n(&seeds.at[static_cast<std::size_t>(y) * static_cast<std::size_t>(seeds.width)], seeds.width,
                &from.layers[0][from.index(0, y)]);
  const NearbyReaches reaches(seeds, static_cast<float>(2 * settings.firstStep));
  for (int step = settings.firstStep; step > 0; step /= 2) {
    const LayerRound round{seeds, settings, from, to, step};
    pool.parallelFor(static_cast<std::size_t>(seeds.height), kRowsAtOnce, [&](std::size_t begin, std::size_t end) {
      for (auto y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
        for (int x = 0; x < seeds.width; x += kFloodTile) {
          if (step == 1 || static_cast<float>(step) <= reaches.at(x, y)) {
            searchLayers(round, x, y);
            continue;
          }
          for (int k = 0; k < kFloodLayers; ++k)
            std::copy_n(&from.layers[k][from.index(x, y)], std::min(kFloodTile, seeds.width - x),
                        &to.layers[k][to.index(x, y)]);
        }
    });
    std::swap(from, to);
  }
  std::vector<FloodLayers> layers(seeds.at.size());
  const auto width = static_cast<std::size_t>(seeds.width);
  pool.parallelFor(static_cast<std::size_t>(seeds.height), kRowsAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t y = begin; y < end; ++y) {
      const std::size_t start = from.index(0, static_cast<int>(y));
      for (std::size_t x = 0; x < width; ++x)
        for (std::size_t k = 0; k < kFloodLayers; ++k) layers[y * width + x][k] = from.layers[k][start + x];
    }
  });
  return layers;
}

std::vector<FloodNeighbours> findNeighbours(const FloodSeeds& seeds, const std::vector<FloodLayers>& layers,
                                            const FloodSettings& settings, const ThreadPool& pool) {
  FloodNeighbours none;
  none.fill(kNoPixel);
  std::vector<FloodNeighbours> from(seeds.at.size(), none), to(seeds.at.size());
  const float least = leastShare(seeds);
  const auto width = static_cast<std::size_t>(seeds.width);
  for (int step = settings.firstStep; step > 0; step /= 2) {
    forEachSeed(seeds, pool, [&](FloodPixel seed, std::size_t i) {
      to[i] = from[i];
      if (static_cast<float>(step) > seeds.reachPx(i)) return;
      Candidates candidates;
      const int x = pixelColumn(seed) / 2, y = pixelRow(seed) / 2;
      for (int v = y - step; v <= y + step; v += step)
        for (int u = x - step; u <= x + step; u += step) {
          if (v < 0 || v >= seeds.height || u < 0 || u >= seeds.width || (u == x && v == y)) continue;
          const std::size_t jump = static_cast<std::size_t>(v) * width + static_cast<std::size_t>(u);
          candidates.add(layers[jump]);
          if (seeds.at[jump] != kNoPixel) candidates.add(from[jump]);
        }
      NeighbourList(seeds, settings, least, seed, to[i]).consider(candidates);
    });
    from.swap(to);
  }
  // A step that the paper does not have: most of what the jumps missed is among the neighbours' neighbours.
  forEachSeed(seeds, pool, [&](FloodPixel seed, std::size_t i) {
    to[i] = from[i];
    Candidates candidates;
    for (const FloodPixel neighbour : from[i])
      if (neighbour != kNoPixel) candidates.add(from[seeds.index(neighbour)]);
    NeighbourList(seeds, settings, least, seed, to[i]).consider(candidates);
  });
  return to;
}

}  // namespace strata
