#include "viewer/tools/pick.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "core/error.h"
#include "tests/support/lod_store.h"

namespace strata {
namespace {

Picture emptyPicture(int width, int height) {
  const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  Picture picture;
  picture.width = width;
  picture.height = height;
  picture.colour.assign(pixels, 0);
  picture.depth.assign(pixels, std::numeric_limits<float>::infinity());
  picture.pointId.assign(pixels, Picture::kNoPoint);
  return picture;
}

void put(Picture& picture, int x, int y, std::uint32_t id, float depth) {
  picture.pointId[static_cast<std::size_t>(y * picture.width + x)] = id;
  picture.depth[static_cast<std::size_t>(y * picture.width + x)] = depth;
}

RenderList threeItems() {
  RenderList list;
  for (const std::uint32_t count : {10u, 5u, 20u}) {
    list.items.push_back({nullptr, count});
    list.pointCount += count;
  }
  return list;
}

TEST(Pick, TheIdOfThePixelNamesItemAndPoint) {
  Picture picture = emptyPicture(8, 8);
  put(picture, 3, 4, 12, 5.0f);
  const auto picked = drawnPointAt(threeItems(), picture, {3.7, 4.2}, 0);
  ASSERT_TRUE(picked);
  EXPECT_EQ(picked->item, 1u);
  EXPECT_EQ(picked->point, 2u);
  for (std::uint32_t id = 0; id < 35; ++id) {
    put(picture, 3, 4, id, 5.0f);
    const auto p = drawnPointAt(threeItems(), picture, {3.5, 4.5}, 0);
    ASSERT_TRUE(p);
    constexpr std::uint32_t kFirst[] = {0, 10, 15};
    EXPECT_EQ(kFirst[p->item] + p->point, id);
  }
}

TEST(Pick, AClickBesideAPointTakesTheNearestWithinReachAndTheNearerOfTwo) {
  Picture picture = emptyPicture(20, 20);
  EXPECT_FALSE(drawnPointAt(threeItems(), picture, {10.5, 10.5}, 5));
  put(picture, 14, 10, 3, 9.0f);
  EXPECT_FALSE(drawnPointAt(threeItems(), picture, {10.5, 10.5}, 3));
  EXPECT_EQ(drawnPointAt(threeItems(), picture, {10.5, 10.5}, 4)->point, 3u);
  put(picture, 10, 14, 4, 2.0f);
  EXPECT_EQ(drawnPointAt(threeItems(), picture, {10.5, 10.5}, 4)->point, 4u);
  put(picture, 11, 10, 5, 50.0f);
  EXPECT_EQ(drawnPointAt(threeItems(), picture, {10.5, 10.5}, 4)->point, 5u);
}

TEST(Pick, OutsideOfThePictureOrBeyondTheListThereIsNothing) {
  Picture picture = emptyPicture(4, 4);
  put(picture, 0, 0, 35, 1.0f);
  EXPECT_FALSE(drawnPointAt(threeItems(), picture, {0.5, 0.5}, 1));
  EXPECT_FALSE(drawnPointAt(threeItems(), picture, {-20.0, 900.0}, 3));
}

TEST(Pick, APointOfASliceIsReadFromThatSlice) {
  const test::Terrain terrain = test::addSlice(test::makeTerrain({.levels = 1}, true), 0);
  const auto store = test::makeStore(terrain);
  ASSERT_EQ(terrain.hierarchy.nodes[0].key, terrain.hierarchy.nodes[1].key);
  for (const std::uint32_t index : {0u, 1u}) {
    const NodePoints points = readAll(*store, index);
    for (const std::uint32_t point : {0u, 1u, 200u}) {
      const glm::dvec3 steps(points.grid[0][point], points.grid[1][point], points.grid[2][point]);
      EXPECT_EQ(lookUpPoint(*store, index, point).position, terrain.info.grid.offset + terrain.info.grid.scale * steps);
    }
    EXPECT_THROW(lookUpPoint(*store, index, 256), Error);
  }
}

TEST(Pick, NumbersHaveTheDigitsOfTheGrid) {
  EXPECT_EQ(gridNumber(630000.0015, 0.001), "630000.002");
  EXPECT_EQ(gridNumber(12.5, 0.01), "12.50");
  EXPECT_EQ(gridNumber(12.00025, 0.00025), "12.00025");
  EXPECT_EQ(gridNumber(7.0, 1.0), "7");
}

TEST(Pick, AttributesAreShownWithTheirScale) {
  const std::uint16_t rgb[3] = {65280, 0, 256};
  std::byte bytes[6];
  std::memcpy(bytes, rgb, 6);
  EXPECT_EQ(attributeText({"rgb", ScalarType::u16, 3, "", 1.0, 0.0}, bytes), "65280 0 256");
  const std::int32_t height = 250;
  std::memcpy(bytes, &height, 4);
  EXPECT_EQ(attributeText({"extra:h", ScalarType::i32, 1, "", 0.01, 10.0}, bytes), "12.5");
}

}  // namespace
}  // namespace strata
