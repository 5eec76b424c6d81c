#include "render/picture/post_process.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <random>

namespace strata {
namespace {

VisibilityBuffer randomBuffer(int width, int height, double filled, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  VisibilityBuffer buffer{width, height, {}};
  for (int i = 0; i < width * height; ++i) {
    const float depth = static_cast<float>(1.0 + unit(random));
    const bool point = unit(random) < filled;
    buffer.pixels.push_back(point ? packPixel(std::bit_cast<std::uint32_t>(depth), static_cast<std::uint32_t>(i))
                                  : kEmptyPixel);
  }
  return buffer;
}

TEST(Dilate, GivesEachPixelTheNearestPointWhoseSquareCoversIt) {
  const ThreadPool pool(2);
  for (const auto& [width, height] : {std::pair{37, 53}, {1, 40}, {40, 1}, {1, 1}}) {
    for (int size = 1; size <= 16; ++size) {
      const VisibilityBuffer before = randomBuffer(width, height, 0.05, static_cast<std::uint32_t>(size));
      VisibilityBuffer expected{width, height, std::vector<PackedPixel>(before.pixels.size(), kEmptyPixel)};
      for (int row = 0; row < height; ++row)
        for (int column = 0; column < width; ++column)
          for (int y = row - (size - 1) / 2; y <= row + size / 2; ++y)
            for (int x = column - (size - 1) / 2; x <= column + size / 2; ++x) {
              if (x < 0 || y < 0 || x >= width || y >= height) continue;
              PackedPixel& target = expected.pixels[static_cast<std::size_t>(y * width + x)];
              target = std::min(target, before.pixels[static_cast<std::size_t>(row * width + column)]);
            }
      VisibilityBuffer found = before;
      dilate(found, PointSizes(size), pool);
      EXPECT_EQ(found.pixels, expected.pixels) << width << " x " << height << ", size " << size;
    }
  }
}

TEST(Dilate, GivesPointsOfGrowingSizeTheSameAsDrawingEachAlone) {
  const ThreadPool pool(2);
  View view;
  view.width = 61;
  view.height = 47;
  DrawOptions options;
  options.pointMetres = 0.2f;
  const PointSizes sizes(options, view);
  VisibilityBuffer before{view.width, view.height, std::vector<PackedPixel>(61 * 47, kEmptyPixel)};
  std::mt19937 random(3);
  std::uniform_real_distribution<float> depth(0.4f, 20.0f);
  for (PackedPixel& pixel : before.pixels)
    if (random() % 40 == 0)
      pixel = packPixel(std::bit_cast<std::uint32_t>(depth(random)), static_cast<std::uint32_t>(random() % 1000));
  VisibilityBuffer expected{view.width, view.height, std::vector<PackedPixel>(before.pixels.size(), kEmptyPixel)};
  for (int row = 0; row < view.height; ++row)
    for (int column = 0; column < view.width; ++column) {
      const PackedPixel point = before.pixels[static_cast<std::size_t>(row * view.width + column)];
      if (point == kEmptyPixel) continue;
      const int size = sizes.at(pixelDepth(point));
      for (int y = std::max(row - (size - 1) / 2, 0); y <= std::min(row + size / 2, view.height - 1); ++y)
        for (int x = std::max(column - (size - 1) / 2, 0); x <= std::min(column + size / 2, view.width - 1); ++x) {
          PackedPixel& target = expected.pixels[static_cast<std::size_t>(y * view.width + x)];
          target = std::min(target, point);
        }
    }
  VisibilityBuffer found = before;
  dilate(found, sizes, pool);
  EXPECT_EQ(found.pixels, expected.pixels);
}

std::vector<float> scratch;

Picture flatPicture(int side, float depth) {
  Picture picture;
  picture.width = picture.height = side;
  const auto count = static_cast<std::size_t>(side * side);
  picture.depth.assign(count, depth);
  picture.pointId.assign(count, 0);
  picture.colour.assign(count, 0xff80ff40u);
  return picture;
}

TEST(EyeDomeLighting, LeavesAFlatPictureAndTheBackgroundAsTheyAre) {
  const ThreadPool pool(1);
  Picture picture = flatPicture(9, 5.0f);
  for (std::size_t i = 0; i < 27; ++i) {
    picture.depth[i] = std::numeric_limits<float>::infinity();
    picture.pointId[i] = Picture::kNoPoint;
  }
  const std::vector<std::uint32_t> before = picture.colour;
  eyeDomeLighting(picture, 1.0f, PointSizes(1), scratch, pool);
  EXPECT_EQ(picture.colour, before);
}

TEST(EyeDomeLighting, DarkensOnlyWhatStandsBehindItsNeighbours) {
  const ThreadPool pool(1);
  Picture picture = flatPicture(9, 5.0f);
  for (std::size_t i = 0; i < picture.depth.size(); ++i)
    if (i % 9 >= 5) picture.depth[i] = 6.0f;
  const std::vector<std::uint32_t> before = picture.colour;
  eyeDomeLighting(picture, 1.0f, PointSizes(1), scratch, pool);
  for (std::size_t i = 0; i < picture.colour.size(); ++i) {
    if (i % 9 == 5)
      EXPECT_LT(picture.colour[i] & 255u, before[i] & 255u);
    else
      EXPECT_EQ(picture.colour[i], before[i]);
    EXPECT_EQ(picture.colour[i] >> 24, 255u);
  }
}

TEST(EyeDomeLighting, DoesNotDependOnTheScaleOfTheScene) {
  const ThreadPool pool(1);
  Picture small = flatPicture(5, 1.0f), large = flatPicture(5, 1024.0f);
  small.depth[12] *= 1.125f;
  large.depth[12] *= 1.125f;
  eyeDomeLighting(small, 0.3f, PointSizes(1), scratch, pool);
  eyeDomeLighting(large, 0.3f, PointSizes(1), scratch, pool);
  EXPECT_EQ(small.colour, large.colour);
}

}  // namespace
}  // namespace strata
