#include "render/flood_search.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace strata {
namespace {

constexpr std::uint32_t kNone = FloodSeeds::kNone;
constexpr std::size_t kRowsAtOnce = 8;
constexpr std::size_t kClosest = 4;  ///< Farias 2014, 4.3

/// Calls visit(index of a pixel `step` away) for the up to eight of them that are in the picture.
template <typename Visit>
void forEachJump(int x, int y, int step, int width, int height, Visit visit) {
  for (int v = y - step; v <= y + step; v += step) {
    if (v < 0 || v >= height) continue;
    for (int u = x - step; u <= x + step; u += step)
      if (u >= 0 && u < width && (u != x || v != y))
        visit(static_cast<std::size_t>(v) * static_cast<std::size_t>(width) + static_cast<std::size_t>(u));
  }
}

/// The two halves of sameLayer(): most pairs end with the first.
inline bool inReach(const FloodSeed& a, const FloodSeed& b) {
  const glm::vec3 apart = b.position - a.position;
  const float reach = std::min(a.reach, b.reach);
  return glm::dot(apart, apart) <= reach * reach;
}

bool alike(const FloodSeed& a, const FloodSeed& b, const FloodSettings& settings) {
  constexpr glm::vec3 kUnknown(0.0f);
  if (a.normal == kUnknown || b.normal == kUnknown) return true;
  const glm::vec3 apart = b.position - a.position;
  const float off = std::max(std::abs(glm::dot(apart, a.normal)), std::abs(glm::dot(apart, b.normal)));
  return std::abs(glm::dot(a.normal, b.normal)) >= settings.angle &&
         off < settings.continuity * std::min(a.reach, b.reach);
}

/// What the layer search asks of most candidates, in little memory.
struct SeedPlace {
  std::int16_t x, y;
  std::int32_t reach2;  ///< squared pixels
};

std::vector<SeedPlace> placesOf(const FloodSeeds& seeds, const FloodSettings& settings) {
  std::vector<SeedPlace> places;
  places.reserve(seeds.seeds.size());
  const auto farthest = static_cast<float>(2 * settings.firstStep);
  for (const FloodSeed& seed : seeds.seeds) {
    const float reach = std::min(seed.reachPx, farthest) + 1.0f;
    places.push_back({static_cast<std::int16_t>(seed.x), static_cast<std::int16_t>(seed.y),
                      static_cast<std::int32_t>(reach * reach)});
  }
  return places;
}

/// The layers of one pixel while candidates come in.
class LayerList {
 public:
  LayerList(const FloodSeeds& seeds, const std::vector<SeedPlace>& places, const FloodSettings& settings, int x, int y,
            FloodLayers& layers)
      : seeds_(seeds), places_(places), settings_(settings), x_(x), y_(y), layers_(layers) {
    for (std::size_t i = 0; i < layers_.size() && layers_[i] != kNone; ++i) distances_[i] = distance2(layers_[i]);
  }

  void consider(std::uint32_t candidate) {
    for (const std::uint32_t layer : layers_)
      if (layer == candidate) return;
    const int distance = distance2(candidate);
    if (distance > places_[candidate].reach2) return;
    std::size_t farthest = 0;
    for (std::size_t i = 0; i < layers_.size(); ++i) {
      if (layers_[i] == kNone) return put(i, candidate, distance);
      const FloodSeed &held = seeds_.seeds[layers_[i]], &other = seeds_.seeds[candidate];
      if (inReach(held, other) && alike(held, other, settings_)) {
        if (closer(distance, candidate, i)) put(i, candidate, distance);
        return;
      }
      if (!closer(distances_[i], layers_[i], farthest)) farthest = i;
    }
    if (closer(distance, candidate, farthest)) put(farthest, candidate, distance);
  }

 private:
  int distance2(std::uint32_t seed) const {
    const int dx = places_[seed].x - x_, dy = places_[seed].y - y_;
    return dx * dx + dy * dy;
  }
  bool closer(int distance, std::uint32_t seed, std::size_t than) const {
    return distance < distances_[than] || (distance == distances_[than] && seed < layers_[than]);
  }
  void put(std::size_t i, std::uint32_t seed, int distance) {
    layers_[i] = seed;
    distances_[i] = distance;
  }

  const FloodSeeds& seeds_;
  const std::vector<SeedPlace>& places_;
  const FloodSettings& settings_;
  int x_, y_;
  FloodLayers& layers_;
  int distances_[kFloodLayers];
};

/// The neighbours of one seed while candidates come in.
class NeighbourList {
 public:
  NeighbourList(const FloodSeeds& seeds, const FloodSettings& settings, std::uint32_t seed, FloodNeighbours& found)
      : seeds_(seeds), settings_(settings), seed_(seeds.seeds[seed]), found_(found) {
    for (std::size_t i = 0; i < found_.size(); ++i)
      if (found_[i] != kNone) distances_[i] = distance2(seeds_.seeds[found_[i]]);
  }

  void consider(std::uint32_t candidate) {
    const FloodSeed& other = seeds_.seeds[candidate];
    if (settings_.sectors) {
      const int dx = int{other.x} - int{seed_.x}, dy = int{other.y} - int{seed_.y};
      const auto sector = static_cast<std::size_t>(floodSector(static_cast<float>(dx), static_cast<float>(dy)));
      if (found_[sector] == candidate) return;
      const float distance = distance2(other);
      if (before(distance, candidate, sector) && fits(distance, other)) put(sector, candidate, distance);
      return;
    }
    const float distance = distance2(other);
    if (!before(distance, candidate, kClosest - 1) || !fits(distance, other)) return;
    std::size_t place = 0;
    for (; place < kClosest && found_[place] != kNone && !before(distance, candidate, place); ++place)
      if (seeds_.seeds[found_[place]].position == other.position) return;
    for (std::size_t i = kClosest - 1; i > place; --i)
      if (found_[i - 1] != kNone) put(i, found_[i - 1], distances_[i - 1]);
    put(place, candidate, distance);
  }

 private:
  float distance2(const FloodSeed& other) const {
    const glm::vec3 apart = other.position - seed_.position;
    return glm::dot(apart, apart);
  }
  bool fits(float distance, const FloodSeed& other) const {
    return distance > 0.0f && inReach(seed_, other) && alike(seed_, other, settings_);
  }
  bool before(float distance, std::uint32_t candidate, std::size_t place) const {
    return found_[place] == kNone || distance < distances_[place] ||
           (distance == distances_[place] && candidate < found_[place]);
  }
  void put(std::size_t i, std::uint32_t candidate, float distance) {
    found_[i] = candidate;
    distances_[i] = distance;
  }

  const FloodSeeds& seeds_;
  const FloodSettings& settings_;
  const FloodSeed& seed_;
  FloodNeighbours& found_;
  float distances_[kFloodNeighbours];
};

}  // namespace

bool sameLayer(const FloodSeed& a, const FloodSeed& b, const FloodSettings& settings) {
  return inReach(a, b) && alike(a, b, settings);
}

int firstFloodStep(const FloodSeeds& seeds, const FloodSettings& settings) {
  float farthest = 1.0f;
  for (const FloodSeed& seed : seeds.seeds) farthest = std::max(farthest, seed.reachPx);
  return static_cast<int>(
      std::bit_floor(static_cast<unsigned>(std::min(farthest, static_cast<float>(settings.firstStep)))));
}

std::vector<FloodLayers> findLayers(const FloodSeeds& seeds, int firstStep, const FloodSettings& settings,
                                    const ThreadPool& pool) {
  FloodLayers none;
  none.fill(kNone);
  std::vector<FloodLayers> from(seeds.at.size(), none), to(seeds.at.size());
  for (std::size_t i = 0; i < seeds.at.size(); ++i) from[i][0] = seeds.at[i];
  const std::vector<SeedPlace> places = placesOf(seeds, settings);
  for (int step = firstStep; step > 0; step /= 2) {
    pool.parallelFor(static_cast<std::size_t>(seeds.height), kRowsAtOnce, [&](std::size_t begin, std::size_t end) {
      for (auto y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
        for (int x = 0; x < seeds.width; ++x) {
          const auto i =
              static_cast<std::size_t>(y) * static_cast<std::size_t>(seeds.width) + static_cast<std::size_t>(x);
          to[i] = from[i];
          LayerList list(seeds, places, settings, x, y, to[i]);
          forEachJump(x, y, step, seeds.width, seeds.height, [&](std::size_t jump) {
            for (const std::uint32_t candidate : from[jump]) {
              if (candidate == kNone) break;
              list.consider(candidate);
            }
          });
        }
    });
    from.swap(to);
  }
  return from;
}

std::vector<FloodNeighbours> findNeighbours(const FloodSeeds& seeds, const std::vector<FloodLayers>& layers,
                                            int firstStep, const FloodSettings& settings, const ThreadPool& pool) {
  FloodNeighbours none;
  none.fill(kNone);
  std::vector<FloodNeighbours> from(seeds.seeds.size(), none), to(seeds.seeds.size());
  constexpr std::size_t kSeedsAtOnce = 1024;
  for (int step = firstStep; step > 0; step /= 2) {
    pool.parallelFor(seeds.seeds.size(), kSeedsAtOnce, [&](std::size_t begin, std::size_t end) {
      for (std::size_t s = begin; s < end; ++s) {
        const FloodSeed& seed = seeds.seeds[s];
        to[s] = from[s];
        if (static_cast<float>(step) > seed.reachPx) continue;
        NeighbourList list(seeds, settings, static_cast<std::uint32_t>(s), to[s]);
        forEachJump(seed.x, seed.y, step, seeds.width, seeds.height, [&](std::size_t jump) {
          for (const std::uint32_t candidate : layers[jump]) {
            if (candidate == kNone) break;
            list.consider(candidate);
          }
          if (seeds.at[jump] == kNone) return;
          for (const std::uint32_t candidate : from[seeds.at[jump]])
            if (candidate != kNone && candidate != s) list.consider(candidate);
        });
      }
    });
    from.swap(to);
  }
  // Not in the paper: what the jumps missed is mostly among the neighbours' neighbours.
  pool.parallelFor(seeds.seeds.size(), kSeedsAtOnce, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      to[s] = from[s];
      NeighbourList list(seeds, settings, static_cast<std::uint32_t>(s), to[s]);
      for (const std::uint32_t neighbour : from[s])
        if (neighbour != kNone)
          for (const std::uint32_t candidate : from[neighbour])
            if (candidate != kNone && candidate != s) list.consider(candidate);
    }
  });
  return to;
}

}  // namespace strata
