#include "viewer/session/layers.h"

#include <gtest/gtest.h>

#include <atomic>

#include "tests/support/lod_store.h"

namespace strata {
namespace {

constexpr std::chrono::seconds kLong{60};

/// Two stores of the same ground, each counting how often it is read.
class LayersOfTwo : public testing::Test {
 protected:
  static std::shared_ptr<const Store> counted(const test::Terrain& terrain, std::atomic<int>& reads) {
    return test::makeStore(terrain, [&reads](std::uint64_t) { ++reads; });
  }
  StreamerOptions options(std::uint64_t budget) const {
    StreamerOptions o;
    o.selection.pointBudget = budget;
    o.selection.pointsPerPixel = 8.0;
    o.selection.occlusion.enabled = false;
    return o;
  }
  /// Points that each layer has in the complete list.
  std::vector<std::uint64_t> pointsOf(Layers& layers) const {
    EXPECT_TRUE(layers.waitUntilComplete(kLong));
    const RenderList& list = layers.beginFrame();
    std::vector<std::uint64_t> points(2, 0);
    for (std::size_t i = 0; i < list.items.size(); ++i) points[layers.indexOfItem(i)] += list.items[i].pointCount;
    return points;
  }

  const test::Terrain terrain_ = test::makeTerrain({.levels = 5}, true);
  const View view_ = test::viewOfTerrain(terrain_.info, 0.5, 0.3, 300.0);
  std::atomic<int> reads_[2] = {0, 0};  // before the layers: they are read until those have gone
  std::vector<std::shared_ptr<const Store>> stores_{counted(terrain_, reads_[0]), counted(terrain_, reads_[1])};
};

TEST_F(LayersOfTwo, ShareTheBudgetEvenly) {
  Layers layers(stores_, options(20'000));
  layers.setView(view_);
  const std::vector<std::uint64_t> points = pointsOf(layers);
  EXPECT_EQ(points[0], points[1]);
  EXPECT_GT(points[0], 5'000u);
  EXPECT_LE(points[0], 10'000u);
}

TEST_F(LayersOfTwo, AHiddenOneCostsNoReadAndLeavesTheWholeBudgetToTheOther) {
  Layers both(stores_, options(20'000)), alone({stores_[0]}, options(20'000));
  both.setShown({true, false});
  both.setView(view_);
  alone.setView(view_);
  const std::vector<std::uint64_t> points = pointsOf(both);
  EXPECT_TRUE(alone.waitUntilComplete(kLong));
  EXPECT_EQ(points[0], alone.beginFrame().pointCount);
  EXPECT_GT(points[0], 10'000u);
  EXPECT_EQ(points[1], 0u);
  EXPECT_EQ(reads_[1], 0);
}

TEST_F(LayersOfTwo, OneThatIsHiddenLaterIsReadNoMoreAndIsBackWithoutReading) {
  Layers layers(stores_, options(20'000));
  layers.setView(view_);
  EXPECT_GT(pointsOf(layers)[1], 0u);
  const int before = reads_[1];
  layers.setShown({true, false});
  for (const double x : {0.1, 0.9, 0.4}) {
    layers.setView(test::viewOfTerrain(terrain_.info, x, 0.2, 60.0));
    EXPECT_EQ(pointsOf(layers)[1], 0u);
  }
  EXPECT_EQ(reads_[1], before);
  layers.setView(view_);
  pointsOf(layers);
  layers.setShown({true, true});
  const std::vector<std::uint64_t> points = pointsOf(layers);
  EXPECT_EQ(points[0], points[1]);
  EXPECT_EQ(reads_[1], before);
}

TEST_F(LayersOfTwo, AllHiddenDrawNothingAndAreComplete) {
  Layers layers(stores_, options(20'000));
  layers.setShown({false, false});
  layers.setView(view_);
  EXPECT_TRUE(layers.waitUntilComplete(kLong));
  EXPECT_TRUE(layers.beginFrame().items.empty());
}

}  // namespace
}  // namespace strata
