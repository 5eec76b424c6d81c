// The schedule of the point pool, compared with a model that remembers when each place was visited.
#include "render/progressive/pool_schedule.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

namespace strata {
namespace {

struct Sizes {
  std::uint32_t size, bands;
};

class PoolTurnOf : public testing::TestWithParam<Sizes> {};

TEST_P(PoolTurnOf, HasBandsThatCoverThePoolInOrder) {
  std::uint32_t at = 0;
  const std::vector<PoolSchedule::Band> bands = PoolSchedule(GetParam().size, GetParam().bands).bands();
  for (const PoolSchedule::Band& band : bands) {
    EXPECT_EQ(band.first, at);
    EXPECT_GT(band.end, band.first);
    at = band.end;
  }
  EXPECT_EQ(at, GetParam().size);
  EXPECT_LE(bands.size(), GetParam().bands);
}

/// Each frame shows random blocks, frees others and visits a random number of places.
TEST_P(PoolTurnOf, MeetsEachPlaceOfItsBandsOnceAndTellsWhenGhostsAreGone) {
  const auto [size, bandCount] = GetParam();
  PoolSchedule turn(size, bandCount);
  const std::vector<PoolSchedule::Band> bands = turn.bands();
  const std::uint32_t block = std::min<std::uint32_t>(size, 700);
  std::mt19937 random(size);
  const auto below = [&](std::uint32_t n) { return static_cast<std::uint32_t>(random()) % n; };
  std::vector<int> met(size), metEver(size);  // in this picture; at all
  struct Ghost {
    std::uint32_t first, count;
    std::vector<int> seenAt;  // metEver of its bands' places when it was freed
  };
  std::map<std::uint32_t, Ghost> ghosts;
  std::uint32_t nextSlot = 0, gone = 0;
  for (int frame = 0; frame < 300; ++frame) {
    std::vector<std::uint32_t> slots;
    turn.beginFrame(slots);
    for (const std::uint32_t slot : slots) {
      const Ghost& ghost = ghosts.at(slot);
      for (std::uint32_t i = 0; i < ghost.count; ++i)
        ASSERT_GT(metEver[ghost.first + i], ghost.seenAt[i]) << "told before all of its places were met";
      ghosts.erase(slot);
      ++gone;
    }
    for (std::uint32_t k = below(4); k > 0; --k) turn.shown(below(size - block + 1), 1 + below(block));
    for (std::uint32_t k = below(3); k > 0; --k) {
      const std::uint32_t first = below(size - block + 1), count = 1 + below(block);
      turn.freed(nextSlot, first, count);
      ghosts[nextSlot++] = {first, count, {metEver.begin() + first, metEver.begin() + first + count}};
    }
    ASSERT_EQ(turn.ghosts().size(), ghosts.size());
    if (below(2) == 0) {
      turn.restart();
      std::fill(met.begin(), met.end(), 0);
      ASSERT_EQ(turn.pending(), turn.places());
    }
    const std::uint64_t before = turn.pending(), count = std::min<std::uint64_t>(before, below(size) + 1);
    std::uint64_t places = 0;
    for (const PoolSchedule::Band& range : turn.next(count)) {
      ASSERT_LT(range.first, range.end);
      places += range.end - range.first;
      for (std::uint32_t i = range.first; i < range.end; ++i) {
        ++metEver[i];
        ASSERT_EQ(++met[i], 1) << "met twice in a turn";
      }
    }
    ASSERT_EQ(places, count);
    ASSERT_EQ(turn.pending(), before - count);
    if (turn.pending() > 0) continue;
    for (const PoolSchedule::Band& band : bands) {  // finished: all of a band or nothing
      const auto first = met.begin() + band.first, end = met.begin() + band.end;
      ASSERT_EQ(std::count(first, end, 1) % static_cast<std::ptrdiff_t>(band.end - band.first), 0);
    }
  }
  EXPECT_GT(gone, 50u);
}

TEST_P(PoolTurnOf, IsAsLongAsTheBandsThatAreShown) {
  const auto [size, bandCount] = GetParam();
  PoolSchedule turn(size, bandCount);
  std::vector<std::uint32_t> slots;
  turn.restart();
  EXPECT_EQ(turn.places(), 0u) << "nothing is shown of any";
  std::uint64_t places = 0;
  for (const PoolSchedule::Band& band : turn.bands()) {
    turn.shown(band.first, 1);
    turn.shown(band.end - 1, 1);
    EXPECT_EQ(turn.places(), places += band.end - band.first);
  }
  turn.restart();
  EXPECT_EQ(turn.pending(), size);
  turn.next(size);
  turn.beginFrame(slots);
  turn.restart();
  EXPECT_EQ(turn.pending(), 0u) << "the next frame shows nothing";
}

TEST_P(PoolTurnOf, ClearsGhostsWithinATurnAlthoughNothingIsShownBesideThem) {
  const auto [size, bandCount] = GetParam();
  PoolSchedule turn(size, bandCount);
  turn.freed(7, 0, size);
  turn.restart();
  std::vector<std::uint32_t> slots;
  turn.next(size - 1);
  turn.beginFrame(slots);
  EXPECT_TRUE(slots.empty()) << "a place is left";
  turn.next(1);
  turn.beginFrame(slots);
  EXPECT_EQ(slots, std::vector<std::uint32_t>{7});
  EXPECT_TRUE(turn.ghosts().empty());
  EXPECT_EQ(turn.places(), 0u);
}

INSTANTIATE_TEST_SUITE_P(Sizes, PoolTurnOf,
                         testing::Values(Sizes{4096, 16}, Sizes{4097, 16}, Sizes{100'000, 16}, Sizes{65'536, 16},
                                         Sizes{65'537, 7}, Sizes{50'001, 1}, Sizes{1001, 16}),
                         [](const auto& tried) {
                           return std::to_string(tried.param.size) + "In" + std::to_string(tried.param.bands);
                         });

/// All bands get equal shares; where a short band has too few places, the others get the rest.
TEST(PoolSchedule, GoesOnInAllBandsEvenly) {
  PoolSchedule turn(16 * 4096 - 3000, 16);
  for (const PoolSchedule::Band& band : turn.bands()) turn.shown(band.first, 1);
  turn.restart();
  std::vector<std::uint32_t> places;
  for (int frame = 0; frame < 2; ++frame) {
    places.assign(16, 0);
    for (const PoolSchedule::Band& range : turn.next(16'000)) places[range.first / 4096] += range.end - range.first;
    if (frame == 0) {
      EXPECT_EQ(places, std::vector<std::uint32_t>(16, 1000));
    }
  }
  EXPECT_EQ(places.back(), 96u);
  for (std::size_t band = 0; band < 15; ++band) EXPECT_NEAR(places[band], (16'000 - 96) / 15, 1);
}

}  // namespace
}  // namespace strata
