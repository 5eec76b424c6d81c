// The shuffles of a pool are bijections that spread neighbours over the pool (Rumpler 2019, 3.2 and 4.2.2).
#include "render/progressive/shuffle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "tests/support/perfect_shuffle.h"

namespace strata {
namespace {

using test::perfectShuffle;
using test::perfectShuffles;

std::vector<std::uint32_t> perfect(std::uint32_t size) {
  std::vector<std::uint32_t> places(size);
  for (std::uint32_t i = 0; i < size; ++i) places[i] = perfectShuffle(i, size, perfectShuffles(size));
  return places;
}

std::vector<std::uint32_t> keyed(std::uint32_t size, std::uint32_t key) {
  const KeyedShuffle shuffle(size, key);
  std::vector<std::uint32_t> places(size);
  for (std::uint32_t i = 0; i < size; ++i) places[i] = shuffle(i);
  return places;
}

bool isBijection(std::vector<std::uint32_t> places) {
  std::sort(places.begin(), places.end());
  for (std::uint32_t i = 0; i < places.size(); ++i)
    if (places[i] != i) return false;
  return true;
}

/// Divides the pool into `shares` parts. Returns the largest fraction, over all parts, of points whose successor lies
/// in the same part. If points are in spatial order, these are drawn side by side in one frame. By chance it is 1 /
/// shares.
double neighboursTogether(const std::vector<std::uint32_t>& places, std::uint32_t shares) {
  const auto size = static_cast<std::uint32_t>(places.size());
  std::vector<std::uint32_t> points(shares), pairs(shares);
  const auto shareOf = [&](std::uint32_t place) {
    return static_cast<std::uint32_t>(std::uint64_t{place} * shares / size);
  };
  for (std::uint32_t i = 0; i + 1 < size; ++i) {
    ++points[shareOf(places[i])];
    pairs[shareOf(places[i])] += shareOf(places[i]) == shareOf(places[i + 1]);
  }
  double most = 0.0;
  for (std::uint32_t s = 0; s < shares; ++s)
    most = std::max(most, static_cast<double>(pairs[s]) / std::max(points[s], 1u));
  return most;
}

/// Counts how many points of each of `ranges` ranges of indices lie in each of `shares` parts of the pool. Returns the
/// largest deviation from the expected count, in standard deviations.
double unevenness(const std::vector<std::uint32_t>& places, std::uint32_t ranges, std::uint32_t shares) {
  const auto size = static_cast<std::uint32_t>(places.size());
  std::vector<std::uint32_t> cells(std::size_t{ranges} * shares);
  for (std::uint32_t i = 0; i < size; ++i)
    ++cells[(std::uint64_t{i} * ranges / size) * shares + std::uint64_t{places[i]} * shares / size];
  const double expected = static_cast<double>(size) / ranges / shares;
  double worst = 0.0;
  for (const std::uint32_t count : cells) worst = std::max(worst, std::abs(count - expected) / std::sqrt(expected));
  return worst;
}

TEST(PerfectShuffle, FollowsTheExampleOfSixteenElements) {
  // Rumpler 2019, Figure 3.1: two iterations.
  const std::vector<std::uint32_t> expected{0, 4, 8, 12, 1, 5, 9, 13, 2, 6, 10, 14, 3, 7, 11, 15};
  std::vector<std::uint32_t> places(16);
  for (std::uint32_t i = 0; i < 16; ++i) places[i] = perfectShuffle(i, 16, 2);
  std::vector<std::uint32_t> inverse(16);
  for (std::uint32_t i = 0; i < 16; ++i) inverse[places[i]] = i;
  EXPECT_EQ(perfectShuffles(16), 2);
  EXPECT_EQ(inverse, expected);
}

TEST(PerfectShuffle, IsABijectionForEvenSizes) {
  for (std::uint32_t size = 2; size <= 2000; size += 2) ASSERT_TRUE(isBijection(perfect(size))) << size;
}

TEST(PerfectShuffle, LeavesAPowerOfTwoAsItWasAfterItsLogarithm) {
  for (std::uint32_t i = 0; i < 4096; ++i) EXPECT_EQ(perfectShuffle(i, 4096, 12), i);
}

TEST(KeyedShuffle, IsABijectionForEverySizeAndKey) {
  for (std::uint32_t size = 1; size <= 3000; ++size) ASSERT_TRUE(isBijection(keyed(size, size * 77))) << size;
  std::mt19937 random(1);
  for (int i = 0; i < 20; ++i) {
    const std::uint32_t size = 1 + static_cast<std::uint32_t>(random()) % 500'000;
    ASSERT_TRUE(isBijection(keyed(size, static_cast<std::uint32_t>(random())))) << size;
  }
}

TEST(KeyedShuffle, GivesAnotherOrderForAnotherKey) {
  const std::vector<std::uint32_t> a = keyed(10000, 1), b = keyed(10000, 2);
  std::size_t same = 0;
  for (std::size_t i = 0; i < a.size(); ++i) same += a[i] == b[i];
  EXPECT_LT(same, 20u);
}

TEST(KeyedShuffle, SpreadsEveryRangeOverEveryShareAsChanceDoes) {
  for (const std::uint32_t size : {1u << 18, 200'000u, 262'145u, 299'993u})
    for (const std::uint32_t key : {0u, 1u, 0xdeadbeefu}) {
      EXPECT_LT(unevenness(keyed(size, key), 64, 16), 5.0) << size << ", key " << key;  // the largest of 1024 cells
      EXPECT_GT(unevenness(keyed(size, key), 64, 16), 1.5) << "too even for chance: the measure sees nothing";
    }
}

/// The pattern of Rumpler's Figures 4.6 and 4.7: with sizes that are powers of two, whole rows of neighbours are drawn
/// in one frame.
TEST(KeyedShuffle, HasNoPatternWherePerfectShuffleHasOne) {
  const std::uint32_t shares = 32;
  for (const std::uint32_t size : {1u << 20, 1u << 19, 1'000'000u, 937'500u, 786'432u}) {
    const double ours = neighboursTogether(keyed(size, 5), shares), his = neighboursTogether(perfect(size), shares);
    EXPECT_LT(ours, 1.2 / shares) << size;
    if (std::has_single_bit(size)) {
      EXPECT_GT(his, 0.9) << size;
    }
  }
}

}  // namespace
}  // namespace strata
