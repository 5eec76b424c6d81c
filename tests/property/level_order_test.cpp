#include "converter/build/level_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <set>

#include "io/store/store.h"
#include "tests/bench/other_samplings.h"
#include "tests/support/evenness.h"

namespace strata {
namespace {

using namespace test;

constexpr glm::dvec3 kLine{200.0, 0.02, 0.02}, kPlane{100.0, 80.0, 0.05}, kVolume{100.0, 80.0, 60.0};

LevelOrder orderOf(const Cloud& cloud, std::size_t capacity = LevelOrder::kAll) {
  TreeScratch scratch;
  return levelOrder(cloud.local(), capacity, scratch);
}

void expectSound(const LevelOrder& levels, std::size_t points, std::size_t kept) {
  ASSERT_EQ(levels.order.size(), kept);
  EXPECT_EQ(std::set<std::uint32_t>(levels.order.begin(), levels.order.end()).size(), kept);
  for (const std::uint32_t i : levels.order) ASSERT_LT(i, points);
  ASSERT_FALSE(levels.prefix.empty());
  EXPECT_TRUE(std::is_sorted(levels.prefix.begin(), levels.prefix.end()));
  EXPECT_EQ(levels.prefix.back(), kept);
  EXPECT_LE(levels.prefix.size(), static_cast<std::size_t>(NodeRecord::kMaxPrefixes));
}

TEST(LevelOrder, KeepsExactlyTheCapacityEachPointOnceWithRisingPrefixes) {
  std::mt19937_64 random(7);
  TreeScratch scratch;
  for (int round = 0; round < 60; ++round) {
    const glm::dvec3 half = round % 3 == 0 ? kLine : round % 3 == 1 ? kPlane : kVolume;
    const Cloud cloud = turnedBox(random, half, random() % 5000, anyTurn(random));
    const std::size_t capacity = 1 + random() % 6000;
    expectSound(levelOrder(cloud.local(), capacity, scratch), cloud.count(), std::min(capacity, cloud.count()));
    expectSound(levelOrder(cloud.local(), LevelOrder::kAll, scratch), cloud.count(), cloud.count());
  }
}

TEST(Sampling, EveryWayKeepsExactlyTheCapacityEachPointOnceWithRisingPrefixes) {
  std::mt19937_64 random(8);
  TreeScratch scratch;
  for (int round = 0; round < 30; ++round) {
    const glm::dvec3 half = round % 3 == 0 ? kLine : round % 3 == 1 ? kPlane : kVolume;
    const Cloud cloud = turnedBox(random, half, random() % 3000, anyTurn(random));
    const std::size_t capacity = 1 + random() % 4000;
    for (const auto order : {poissonOrder, randomOrder}) {
      const LevelOrder levels = order(cloud.local(), capacity, scratch);
      expectSound(levels, cloud.count(), std::min(capacity, cloud.count()));
    }
  }
  Cloud copies;
  for (auto& axis : copies.axis) axis.assign(5000, 77);
  expectSound(poissonOrder(copies.local(), 1000, scratch), 5000, 1000);
}

TEST(Sampling, NoTwoPointsOfAPoissonPrefixAreCloserThanItsDistance) {
  std::mt19937_64 random(6);
  const Cloud cloud = turnedBox(random, {100.0, 100.0, 0.01}, 60000, anyTurn(random));
  TreeScratch scratch;
  const LevelOrder levels = poissonOrder(cloud.local(), 4000, scratch);
  const double rootSide = rootSideOf(cloud.local(), 4000, scratch);
  for (std::size_t l = 1; l + 1 < levels.prefix.size(); ++l) {
    const double distance = rootSide > 0.0 ? rootSide * std::ldexp(1.0, -static_cast<int>(l)) : 0.0;
    for (std::uint32_t i = 0; i < levels.prefix[l]; ++i)
      for (std::uint32_t j = 0; j < i; ++j)
        ASSERT_GE(glm::length(cloud.position(levels.order[i]) - cloud.position(levels.order[j])), distance);
  }
}

TEST(Sampling, EveryPointIsRepresentedByAKeptOneAndKeptOnesByThemselves) {
  std::mt19937_64 random(4);
  const Cloud cloud = turnedBox(random, kPlane, 20000, anyTurn(random));
  TreeScratch scratch;
  for (const auto order : {levelOrder, poissonOrder, randomOrder}) {
    const LevelOrder levels = order(cloud.local(), 2000, scratch);
    const std::vector<std::uint32_t> by = representedBy(scratch, cloud.count(), levels.order);
    ASSERT_EQ(by.size(), cloud.count());
    double farthest = 0.0;
    for (std::uint32_t i = 0; i < by.size(); ++i) {
      ASSERT_LT(by[i], levels.order.size());
      farthest = std::max(farthest, glm::length(cloud.position(i) - cloud.position(levels.order[by[i]])));
    }
    for (std::uint32_t place = 0; place < levels.order.size(); ++place) EXPECT_EQ(by[levels.order[place]], place);
    if (order == levelOrder) {
      EXPECT_LT(farthest, 6.0 * levels.spacing);
    }
  }
}

TEST(LevelOrder, CopiesOfOnePointAllStay) {
  Cloud cloud;
  for (auto& axis : cloud.axis) axis.assign(20000, 77);
  expectSound(orderOf(cloud), 20000, 20000);
  expectSound(orderOf(cloud, 100), 20000, 100);
}

TEST(LevelOrder, AMillimetreFullOfPointsInAKilometreIsToldApart) {
  // 10 levels of the volume's tree do not: a cell of the tenth holds all the points but one.
  std::mt19937_64 random(5);
  Cloud cloud = turnedBox(random, glm::dvec3(0.05), 20000, anyTurn(random));
  for (auto& axis : cloud.axis) axis.push_back(0);
  const LevelOrder levels = orderOf(cloud, 10000);
  std::set<std::array<std::int32_t, 3>> cells;
  for (const std::uint32_t i : levels.order)
    cells.insert({cloud.axis[0][i] / 8, cloud.axis[1][i] / 8, cloud.axis[2][i] / 8});
  EXPECT_GT(cells.size(), 1500u);  // of 1700 or so that are occupied
}

TEST(LevelOrder, TheOrderDoesNotDependOnWhatTheScratchHeldBefore) {
  std::mt19937_64 random(9);
  const Cloud a = turnedBox(random, kPlane, 30000, anyTurn(random));
  const Cloud b = turnedBox(random, kVolume, 50000, anyTurn(random));
  TreeScratch scratch;
  levelOrder(b.local(), 1000, scratch);
  EXPECT_EQ(levelOrder(a.local(), 5000, scratch).order, orderOf(a, 5000).order);
}

ContourClass classOf(const Cloud& cloud) {
  TreeScratch scratch;
  return buildTree(cloud.local(), LevelOrder::kAll, scratch).shape;
}

TEST(NTree, IsBinaryOnALineQuadOnAPlaneAndOctInAVolumeAtAnyRotation) {
  std::mt19937_64 random(1);
  for (int round = 0; round < 100; ++round) {
    EXPECT_EQ(classOf(turnedBox(random, kLine, 500, anyTurn(random))), ContourClass::linear);
    EXPECT_EQ(classOf(turnedBox(random, kPlane, 500, anyTurn(random))), ContourClass::planar);
    EXPECT_EQ(classOf(turnedBox(random, kVolume, 500, anyTurn(random))), ContourClass::volumetric);
  }
}

TEST(NTree, EachCellOfEachLevelIsRepresentedByTheFirstOfItsPoints) {
  std::mt19937_64 random(2);
  for (const glm::dvec3& half : {kLine, kPlane, kVolume}) {
    const Cloud cloud = turnedBox(random, half, 4000, anyTurn(random));
    TreeScratch scratch;
    const NTree tree = buildTree(cloud.local(), LevelOrder::kAll, scratch);
    const int levelBits = tree.shape == ContourClass::linear ? 1 : tree.shape == ContourClass::planar ? 2 : 3;
    const int levels = levelBits == 1 ? 24 : levelBits == 2 ? 15 : 10;
    for (int level = 0; level <= levels; ++level) {
      std::set<std::uint64_t> seen;
      for (std::size_t i = 0; i < tree.entries.size(); ++i) {
        const bool first = seen.insert(tree.entries[i] >> (32 + levelBits * (levels - level))).second;
        ASSERT_EQ(first, tree.ranks[i] / NTree::kPasses <= level) << "level " << level << ", entry " << i;
      }
    }
  }
}

TEST(LevelOrder, LeafDepthsDifferByAtMostOne) {
  std::mt19937_64 random(3);
  for (const glm::dvec3& half : {kLine, kPlane, kVolume})
    for (const std::size_t capacity : {1u, 7u, 100u, 1000u, 5000u}) {
      const Cloud cloud = turnedBox(random, half, 20000, anyTurn(random));
      TreeScratch scratch;
      const LevelOrder levels = levelOrder(cloud.local(), capacity, scratch);
      const std::set<std::uint32_t> kept(levels.order.begin(), levels.order.end());
      const NTree tree = buildTree(cloud.local(), capacity, scratch);
      int lowestLeftOut = NTree::kBeyond, highestKept = 0;
      for (std::size_t i = 0; i < tree.entries.size(); ++i) {
        const int level = tree.ranks[i] / NTree::kPasses;
        if (kept.count(tree.point(i)) > 0)
          highestKept = std::max(highestKept, level);
        else
          lowestLeftOut = std::min(lowestLeftOut, level);
      }
      // All levels below `lowestLeftOut` are whole, and nothing is kept beyond it.
      EXPECT_LE(highestKept, lowestLeftOut);
    }
}

TEST(LevelOrder, EveryPrefixOfADensePlaneIsMoreEvenThanRandomPointsAtAnyRotation) {
  std::mt19937_64 random(13);
  for (int round = 0; round < 6; ++round) {
    const Cloud cloud = turnedBox(random, {100.0, 100.0, 0.01}, 200000, anyTurn(random));
    const LevelOrder levels = orderOf(cloud, 16384);
    const Evenness evenness = evennessOf(cloud, levels.order, levels.prefix);
    RecordProperty("full levels", std::to_string(evenness.fullLevels));
    RecordProperty("anywhere", std::to_string(evenness.anywhere));
    EXPECT_LE(evenness.fullLevels, 0.30);
    EXPECT_LE(evenness.anywhere, 0.45);
  }
}

TEST(LevelOrder, EveryPrefixSpreadsOverAllQuartersOfAPlane) {
  std::mt19937_64 random(17);
  const Cloud cloud = turnedBox(random, {100.0, 100.0, 0.01}, 60000, glm::dquat(1.0, 0.0, 0.0, 0.0));
  const LevelOrder levels = orderOf(cloud);
  for (std::size_t prefix = 400; prefix < cloud.count(); prefix = prefix * 21 / 20) {
    std::map<int, std::size_t> quarters;
    for (std::size_t i = 0; i < prefix; ++i) {
      const std::uint32_t p = levels.order[i];
      ++quarters[(cloud.axis[0][p] >> 19) * 2 + (cloud.axis[1][p] >> 19)];
    }
    ASSERT_EQ(quarters.size(), 4u);
    for (const auto& [quarter, count] : quarters)
      EXPECT_NEAR(static_cast<double>(count), static_cast<double>(prefix) / 4.0, static_cast<double>(prefix) * 0.06)
          << "prefix " << prefix;
  }
}

TEST(LevelOrder, SpacingIsTheDistanceOfNeighboursOnAPlane) {
  std::mt19937_64 random(23);
  for (int round = 0; round < 5; ++round) {
    const Cloud cloud = turnedBox(random, {100.0, 100.0, 0.01}, 100000, anyTurn(random));
    const double even = 200.0 / std::sqrt(10000.0);
    EXPECT_NEAR(orderOf(cloud, 10000).spacing, even, 0.25 * even);
  }
}

}  // namespace
}  // namespace strata
