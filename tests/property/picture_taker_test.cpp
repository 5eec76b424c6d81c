// Pictures written part by part while their detail streams in.
#include "viewer/output/picture_taker.h"
#include "render/create_rasterizer.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "core/error.h"
#include "tests/support/lod_store.h"
#include "tests/support/test_data.h"

namespace strata {
namespace {

using std::chrono::milliseconds;

class PictureTakerTest : public testing::Test {
 protected:
  static Layers layersOf(std::uint64_t cacheBytes) {
    static const test::Terrain terrain = test::makeTerrain({6, 24, 16}, true);
    StreamerOptions options;
    options.cacheBytes = cacheBytes;
    return Layers({test::makeStore(terrain)}, options);
  }

  static PictureOrder order(const std::string& file, int width, int height) {
    PictureOrder order;
    order.file = file;
    order.view = test::viewOfTerrain(test::terrainInfo({6, 24, 16}), 0.5, 0.1, 6.0, width, height);
    order.draw.pointSize = 4;
    order.draw.edl = true;
    order.draw.fill = 5;
    order.draw.shading = Shading::highQuality;
    return order;
  }

  /// Drawn in one piece, with room for everything.
  static Picture whole(const PictureOrder& order) {
    Layers layers = layersOf(std::uint64_t{1} << 30);
    SelectionOptions selection = order.selection;
    selection.pointBudget = SelectionOptions::kMaxPointBudget;
    selection.occlusion.enabled = false;
    layers.setSelection(selection);
    layers.setView(order.view);
    EXPECT_TRUE(layers.waitUntilComplete(milliseconds(20000)));
    Picture frame;
    createRasterizer(Backend::cpu, {}, nullptr)->draw(layers.beginFrame(), order.view, order.draw, frame);
    return frame;
  }

  static void take(PictureTaker& taker) {
    double before = 0.0;
    while (!taker.goOn(milliseconds(1000))) {
      EXPECT_GE(taker.progress(), before);
      before = taker.progress();
    }
    EXPECT_EQ(taker.progress(), 1.0);
  }

  const test::TempFolder folder_;
  const std::string file_ = (folder_ / "picture.png").string();
  const std::unique_ptr<Rasterizer> rasterizer_ = createRasterizer(Backend::cpu, {}, nullptr);
};

TEST_F(PictureTakerTest, WritesThePictureThatOneFrameWouldBe) {
  const PictureOrder asked = order(file_, 2200, 1500);
  Layers layers = layersOf(std::uint64_t{1} << 30);
  PictureTaker taker(asked, layers, *rasterizer_);
  take(taker);
  EXPECT_EQ(taker.unfinishedParts(), 0);
  EXPECT_LT(taker.frame().width, 1200);
  EXPECT_EQ(readPng(file_).pixels, whole(asked).colour);
}

TEST_F(PictureTakerTest, APartWhoseNodesDoNotFitTheCacheIsDrawnInPieces) {
  const PictureOrder asked = order(file_, 1300, 900);
  Layers layers = layersOf(std::uint64_t{400} << 10);
  layers.setSelection([] {
    SelectionOptions all;
    all.pointBudget = SelectionOptions::kMaxPointBudget;
    all.occlusion.enabled = false;
    return all;
  }());
  layers.setView(asked.view);
  ASSERT_TRUE(layers.waitUntilComplete(milliseconds(20000)));
  ASSERT_GT(layers.stats().overCapacity, 0u) << "the cache is no tight one";
  PictureTaker taker(asked, layers, *rasterizer_);
  take(taker);
  EXPECT_EQ(taker.unfinishedParts(), 0);
  EXPECT_EQ(readPng(file_).pixels, whole(asked).colour);
}

TEST_F(PictureTakerTest, OneThatIsGivenUpLeavesNoFile) {
  {
    Layers layers = layersOf(std::uint64_t{1} << 30);
    PictureTaker taker(order(file_, 3000, 3000), layers, *rasterizer_);
    for (int i = 0; i < 2000 && taker.progress() == 0.0; ++i) EXPECT_FALSE(taker.goOn(milliseconds(10)));
    EXPECT_GT(taker.progress(), 0.0);
  }
  EXPECT_TRUE(std::filesystem::is_empty(std::filesystem::path(file_).parent_path()));
}

TEST_F(PictureTakerTest, RefusesWhatItCannotWriteOrPart) {
  Layers layers = layersOf(std::uint64_t{1} << 30);
  EXPECT_THROW(PictureTaker(order("/nowhere/x.png", 100, 100), layers, *rasterizer_), Error);
  PictureOrder overdraw = order(file_, 8000, 8000);
  overdraw.draw.colour = ColourMode::overdraw;
  EXPECT_THROW(PictureTaker(overdraw, layers, *rasterizer_), Error);
}

TEST(PictureScale, PointsCoverAsMuchOfALargePictureAsOfTheScreen) {
  DrawOptions draw;
  draw.pointSize = 2;
  EXPECT_EQ(scaledToPicture(draw, 800, 3200).pointSize, 8);
  EXPECT_EQ(scaledToPicture(draw, 800, 100).pointSize, 1);
  EXPECT_EQ(scaledToPicture(draw, 100, 16384).pointSize, DrawOptions::kLargestPoint);
}

}  // namespace
}  // namespace strata
