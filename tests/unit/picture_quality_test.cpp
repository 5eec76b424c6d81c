#include "tests/support/picture_quality.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace strata::test {
namespace {

View smallView() {
  View view;
  view.eye = {0.0, 0.0, 0.0};
  view.target = {0.0, 1.0, 0.0};
  view.fovY = 2.0 * std::atan(0.5);  // at 10 m a metre is `height` / 10 pixels
  view.width = 40;
  view.height = 20;
  return view;
}

MeanPicture grey(int width, int height, double value) {
  const auto pixels = static_cast<std::size_t>(width * height);
  return {width, height, std::vector<glm::dvec3>(pixels, glm::dvec3(value)), std::vector<std::uint8_t>(pixels, 1)};
}

Picture frameOf(const MeanPicture& picture) {
  Picture frame;
  frame.width = picture.width;
  frame.height = picture.height;
  for (const glm::dvec3& c : picture.colour) {
    const glm::uvec3 u(c + 0.5);
    frame.colour.push_back(u.x | u.y << 8 | u.z << 16 | 0xff000000u);
    frame.pointId.push_back(0);
    frame.depth.push_back(1.0f);
  }
  return frame;
}

TEST(MeanPicture, AveragesWhatLiesWithinOnePercentOfTheFrontDepthAndNothingBehind) {
  const struct {
    glm::dvec3 position;
    glm::u8vec3 colour;
  } points[] = {{{0.01, 10.0, 0.01}, {10, 20, 30}},
                {{0.01, 10.0999, 0.01}, {30, 40, 60}},
                {{0.01, 10.1001, 0.01}, {255, 255, 255}},
                {{0.01, 9.9999, 0.01}, {20, 30, 3}},
                {{0.01, -10.0, 0.01}, {255, 0, 0}},
                {{9.0, 10.0, 0.0}, {70, 80, 90}},
                {{19.9, 10.0, 0.0}, {1, 2, 3}}};
  MeanPictureMaker maker(smallView());
  for (const auto& point : points) maker.addDepth(point.position);
  for (const auto& point : points) maker.addColour(point.position, point.colour);
  const MeanPicture picture = maker.finish({24, 26, 30});
  EXPECT_EQ(picture.coveredPixels(), 2u);
  // The front is at 9.9999 m, so 10.0999 m is more than 1 % behind it by a hair and is left out.
  EXPECT_EQ(picture.colour[9 * 40 + 20], glm::dvec3(15.0, 25.0, 16.5));
  EXPECT_EQ(picture.colour[10 * 40 + 38], glm::dvec3(70.0, 80.0, 90.0));
  EXPECT_EQ(picture.colour[0], glm::dvec3(24.0, 26.0, 30.0));
}

TEST(PictureQuality, OfAPictureAgainstItselfIsPerfect) {
  MeanPicture reference = grey(40, 20, 100.0);
  std::mt19937 random(1);
  for (glm::dvec3& colour : reference.colour) colour = {random() % 256, random() % 256, random() % 256};
  const PictureQuality quality = pictureQuality(reference, frameOf(reference));
  EXPECT_EQ(quality.psnr, std::numeric_limits<double>::infinity());
  EXPECT_NEAR(quality.ssim, 1.0, 1e-12);
  EXPECT_EQ(quality.covered, 1.0);
}

TEST(PictureQuality, OfAnEvenOffsetIsWhatTheFormulasSay) {
  const MeanPicture reference = grey(40, 20, 100.0);
  const PictureQuality quality = pictureQuality(reference, frameOf(grey(40, 20, 110.0)));
  EXPECT_NEAR(quality.psnr, 20.0 * std::log10(25.5), 1e-9);
  const double c1 = 2.55 * 2.55;
  EXPECT_NEAR(quality.ssim, (2.0 * 100.0 * 110.0 + c1) / (100.0 * 100.0 + 110.0 * 110.0 + c1), 1e-9);
}

TEST(PictureQuality, CountsHolesButNotWhatTheReferenceLeavesEmpty) {
  MeanPicture reference = grey(40, 20, 100.0);
  Picture drawn = frameOf(reference);
  for (std::size_t i = 0; i < 400; ++i) reference.covered[i] = 0;
  for (std::size_t i = 0; i < 400; ++i) drawn.colour[i] = 0;
  EXPECT_EQ(pictureQuality(reference, drawn).psnr, std::numeric_limits<double>::infinity());
  for (std::size_t i = 400; i < 500; ++i) {
    drawn.pointId[i] = Picture::kNoPoint;
    drawn.colour[i] = 0;
  }
  const PictureQuality quality = pictureQuality(reference, drawn);
  EXPECT_DOUBLE_EQ(quality.covered, 0.75);
  EXPECT_NEAR(quality.psnr, 10.0 * std::log10(255.0 * 255.0 / 2500.0), 1e-9);
}

/// SSIM of one window, straight from the definition.
double ssimAt(const std::vector<double>& a, const std::vector<double>& b, int width, int x, int y) {
  double sum = 0.0, meanA = 0.0, meanB = 0.0, varianceA = 0.0, varianceB = 0.0, covariance = 0.0;
  const auto eachPixel = [&](auto&& visit) {
    for (int v = -5; v <= 5; ++v)
      for (int u = -5; u <= 5; ++u) {
        const auto i = static_cast<std::size_t>((y + v) * width + x + u);
        visit(std::exp(-(u * u + v * v) / (2.0 * 1.5 * 1.5)), a[i], b[i]);
      }
  };
  eachPixel([&](double w, double, double) { sum += w; });
  eachPixel([&](double w, double p, double q) { meanA += w / sum * p, meanB += w / sum * q; });
  eachPixel([&](double w, double p, double q) {
    varianceA += w / sum * (p - meanA) * (p - meanA);
    varianceB += w / sum * (q - meanB) * (q - meanB);
    covariance += w / sum * (p - meanA) * (q - meanB);
  });
  const double c1 = 2.55 * 2.55, c2 = 7.65 * 7.65;
  return (2.0 * meanA * meanB + c1) * (2.0 * covariance + c2) /
         ((meanA * meanA + meanB * meanB + c1) * (varianceA + varianceB + c2));
}

TEST(SsimMap, IsThatOfTheDefinitionInEveryWindow) {
  constexpr int kWidth = 23, kHeight = 17;
  std::mt19937 random(2);
  std::vector<double> a, b;
  for (int i = 0; i < kWidth * kHeight; ++i) {
    a.push_back(static_cast<double>(random() % 256));
    b.push_back(0.5 * a.back() + static_cast<double>(random() % 128));
  }
  const std::vector<double> map = ssimMap(a, b, kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const bool fits = x >= 5 && y >= 5 && x < kWidth - 5 && y < kHeight - 5;
      EXPECT_NEAR(map[static_cast<std::size_t>(y * kWidth + x)], fits ? ssimAt(a, b, kWidth, x, y) : -2.0, 1e-9);
    }
}

TEST(Psnr, OfTwoFramesCountsEveryPixel) {
  Picture a = frameOf(grey(10, 10, 50.0)), b = a;
  EXPECT_EQ(psnr(a, b), std::numeric_limits<double>::infinity());
  b.colour[0] ^= 0xff;  // red 50 becomes 205
  EXPECT_NEAR(psnr(a, b), 10.0 * std::log10(255.0 * 255.0 * 300.0 / (155.0 * 155.0)), 1e-9);
}

}  // namespace
}  // namespace strata::test
