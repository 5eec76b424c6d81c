#include "converter/level_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <set>

#include "core/morton.h"
#include "io/store.h"

namespace strata {
namespace {

constexpr int kLevels = 12;

std::vector<std::uint64_t> planeKeys(std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<std::uint64_t> keys;
  for (std::size_t i = 0; i < count; ++i) keys.push_back(mortonCode(random() & 4095, random() & 4095, 2000));
  std::sort(keys.begin(), keys.end());
  return keys;
}

std::vector<std::uint64_t> volumeKeys(std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<std::uint64_t> keys;
  for (std::size_t i = 0; i < count; ++i) keys.push_back(mortonCode(random() & 4095, random() & 4095, random() & 4095));
  std::sort(keys.begin(), keys.end());
  return keys;
}

TEST(LevelOrder, IsAPermutationWithRisingPrefixesThatEndAtTheCount) {
  std::mt19937_64 random(7);
  for (int round = 0; round < 40; ++round) {
    const auto keys = round % 2 == 0 ? planeKeys(random() % 3000, random()) : volumeKeys(random() % 3000, random());
    const LevelOrder levels = levelOrder({keys, kLevels});
    std::vector<std::uint32_t> sorted = levels.order;
    std::sort(sorted.begin(), sorted.end());
    std::vector<std::uint32_t> all(keys.size());
    std::iota(all.begin(), all.end(), 0u);
    ASSERT_EQ(sorted, all);
    ASSERT_FALSE(levels.prefix.empty());
    ASSERT_LE(levels.prefix.size(), static_cast<std::size_t>(NodeRecord::kMaxPrefixes));
    ASSERT_TRUE(std::is_sorted(levels.prefix.begin(), levels.prefix.end()));
    ASSERT_EQ(levels.prefix.back(), keys.size());
  }
}

TEST(LevelOrder, EveryLevelHasExactlyOnePointInEachOccupiedCellThatHadNone) {
  const auto keys = volumeKeys(4000, 3);
  const LevelOrder levels = levelOrder({keys, kLevels});
  for (std::size_t l = 0; l + 1 < levels.prefix.size(); ++l) {
    const int shift = 3 * (kLevels - static_cast<int>(l));
    std::set<std::uint64_t> covered, occupied;
    for (std::uint32_t i = 0; i < levels.prefix[l]; ++i) covered.insert(keys[levels.order[i]] >> shift);
    for (const std::uint64_t k : keys) occupied.insert(k >> shift);
    EXPECT_EQ(covered, occupied) << "level " << l;
    EXPECT_EQ(levels.prefix[l], occupied.size()) << "level " << l;
  }
}

TEST(LevelOrder, CopiesOfOnePointAllStay) {
  const std::vector<std::uint64_t> keys(20000, mortonCode(5, 6, 7));
  const LevelOrder levels = levelOrder({keys, kLevels});
  EXPECT_EQ(levels.order.size(), keys.size());
}

TEST(SelectRepresentatives, FillsTheCapacityWhereThereAreCellsEnough) {
  for (const std::size_t capacity : {1u, 7u, 100u, 1000u, 5000u}) {
    const auto keys = planeKeys(20000, 11);
    const auto kept = selectRepresentatives({keys, kLevels}, capacity);
    EXPECT_LE(kept.size(), capacity);
    EXPECT_GE(kept.size(), capacity * 99 / 100) << capacity;
    EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end()));
    EXPECT_EQ(std::set<std::uint32_t>(kept.begin(), kept.end()).size(), kept.size());
  }
}

/// Coefficient of variation of the distances to the nearest neighbour: 0.52 for random points of a plane, 0 on a grid.
double nearestNeighbourVariation(const std::vector<glm::dvec2>& points) {
  std::vector<double> distances;
  for (std::size_t i = 0; i < points.size(); ++i) {
    double best = 1e300;
    for (std::size_t j = 0; j < points.size(); ++j)
      if (j != i) best = std::min(best, glm::length(points[i] - points[j]));
    distances.push_back(best);
  }
  const double mean = std::accumulate(distances.begin(), distances.end(), 0.0) / static_cast<double>(distances.size());
  double variance = 0.0;
  for (const double d : distances) variance += (d - mean) * (d - mean) / static_cast<double>(distances.size());
  return std::sqrt(variance) / mean;
}

TEST(LevelOrder, FullLevelsOfADensePlaneAreMoreEvenThanRandomPoints) {
  std::mt19937_64 random(13);
  std::vector<std::pair<std::uint64_t, glm::dvec2>> plane;
  for (int i = 0; i < 200000; ++i) {
    const std::uint64_t x = random() & 4095, y = random() & 4095;
    plane.push_back({mortonCode(x, y, 2000), glm::dvec2(x, y)});
  }
  std::sort(plane.begin(), plane.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::uint64_t> keys;
  for (const auto& p : plane) keys.push_back(p.first);
  const LevelOrder levels = levelOrder({keys, kLevels});
  for (const std::size_t level : {4u, 5u, 6u}) {
    std::vector<glm::dvec2> shown;
    for (std::uint32_t i = 0; i < levels.prefix[level]; ++i) shown.push_back(plane[levels.order[i]].second);
    EXPECT_LE(nearestNeighbourVariation(shown), 0.45) << "level " << level;
  }
}

TEST(LevelOrder, EveryPrefixSpreadsOverAllQuartersOfAPlane) {
  const auto keys = planeKeys(60000, 17);
  const LevelOrder levels = levelOrder({keys, kLevels});
  for (std::size_t prefix = 400; prefix < keys.size(); prefix = prefix * 21 / 20) {
    std::map<std::uint64_t, std::size_t> quarters;
    for (std::size_t i = 0; i < prefix; ++i) ++quarters[keys[levels.order[i]] >> (3 * (kLevels - 1))];
    ASSERT_EQ(quarters.size(), 4u);
    for (const auto& [quarter, count] : quarters)
      EXPECT_NEAR(static_cast<double>(count), static_cast<double>(prefix) / 4.0, static_cast<double>(prefix) * 0.06)
          << "prefix " << prefix;
  }
}

}  // namespace
}  // namespace strata
