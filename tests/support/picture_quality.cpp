#include "tests/support/picture_quality.h"

#include <array>
#include <cmath>
#include <limits>

namespace strata::test {
namespace {

constexpr int kRadius = 5;
constexpr double kSigma = 1.5;
constexpr double kC1 = (0.01 * 255.0) * (0.01 * 255.0);
constexpr double kC2 = (0.03 * 255.0) * (0.03 * 255.0);
constexpr double kNoWindow = -2.0;

glm::dvec3 unpack(std::uint32_t colour) { return {colour & 255u, colour >> 8 & 255u, colour >> 16 & 255u}; }

/// The luminance of a colour by ITU-R BT.601.
double luminance(const glm::dvec3& rgb) { return 0.299 * rgb.x + 0.587 * rgb.y + 0.114 * rgb.z; }

double decibels(double meanSquare) {
  return meanSquare > 0.0 ? 10.0 * std::log10(255.0 * 255.0 / meanSquare) : std::numeric_limits<double>::infinity();
}

std::array<double, 2 * kRadius + 1> window() {
  std::array<double, 2 * kRadius + 1> weights{};
  double sum = 0.0;
  for (int i = -kRadius; i <= kRadius; ++i)
    sum += weights[static_cast<std::size_t>(i + kRadius)] = std::exp(-0.5 * i * i / (kSigma * kSigma));
  for (double& weight : weights) weight /= sum;
  return weights;
}

/// The weighted mean of the 11 x 11 pixels around each pixel. Values within kRadius of the border are undefined.
std::vector<double> blurred(const std::vector<double>& values, int width, int height) {
  static const auto weights = window();
  std::vector<double> rows(values.size(), 0.0), result(values.size(), 0.0);
  const auto at = [width](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
  };
  for (int y = 0; y < height; ++y)
    for (int x = kRadius; x < width - kRadius; ++x)
      for (int i = -kRadius; i <= kRadius; ++i)
        rows[at(x, y)] += weights[static_cast<std::size_t>(i + kRadius)] * values[at(x + i, y)];
  for (int y = kRadius; y < height - kRadius; ++y)
    for (int i = -kRadius; i <= kRadius; ++i)
      for (int x = kRadius; x < width - kRadius; ++x)
        result[at(x, y)] += weights[static_cast<std::size_t>(i + kRadius)] * rows[at(x, y + i)];
  return result;
}

std::vector<double> product(std::span<const double> a, std::span<const double> b) {
  std::vector<double> result(a.size());
  for (std::size_t i = 0; i < a.size(); ++i) result[i] = a[i] * b[i];
  return result;
}

}  // namespace

std::vector<double> ssimMap(std::span<const double> a, std::span<const double> b, int width, int height) {
  const std::vector<double> meanA = blurred({a.begin(), a.end()}, width, height);
  const std::vector<double> meanB = blurred({b.begin(), b.end()}, width, height);
  const std::vector<double> squareA = blurred(product(a, a), width, height);
  const std::vector<double> squareB = blurred(product(b, b), width, height);
  const std::vector<double> mixed = blurred(product(a, b), width, height);
  std::vector<double> map(a.size(), kNoWindow);
  for (int y = kRadius; y < height - kRadius; ++y)
    for (int x = kRadius; x < width - kRadius; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
      const double varianceA = squareA[i] - meanA[i] * meanA[i];
      const double varianceB = squareB[i] - meanB[i] * meanB[i];
      const double covariance = mixed[i] - meanA[i] * meanB[i];
      map[i] = (2.0 * meanA[i] * meanB[i] + kC1) * (2.0 * covariance + kC2) /
               ((meanA[i] * meanA[i] + meanB[i] * meanB[i] + kC1) * (varianceA + varianceB + kC2));
    }
  return map;
}

double coveredShare(const MeanPicture& reference, const Picture& drawn) {
  std::uint64_t pixels = 0, covered = 0;
  for (std::size_t i = 0; i < reference.covered.size(); ++i) {
    if (reference.covered[i] == 0) continue;
    ++pixels;
    covered += drawn.pointId[i] != Picture::kNoPoint ? 1u : 0u;
  }
  return pixels == 0 ? 1.0 : static_cast<double>(covered) / static_cast<double>(pixels);
}

PictureQuality pictureQuality(const MeanPicture& reference, const Picture& drawn) {
  PictureQuality quality;
  quality.covered = coveredShare(reference, drawn);
  std::vector<double> greyA, greyB;
  double squares = 0.0;
  for (std::size_t i = 0; i < reference.colour.size(); ++i) {
    const glm::dvec3 colour = unpack(drawn.colour[i]);
    const glm::dvec3 difference = colour - reference.colour[i];
    if (reference.covered[i] != 0) squares += glm::dot(difference, difference);
    greyA.push_back(luminance(reference.colour[i]));
    greyB.push_back(luminance(colour));
  }
  quality.psnr = decibels(squares / (3.0 * static_cast<double>(reference.coveredPixels())));

  const std::vector<double> map = ssimMap(greyA, greyB, reference.width, reference.height);
  double sum = 0.0, windows = 0.0;
  for (std::size_t i = 0; i < map.size(); ++i) {
    if (reference.covered[i] == 0 || map[i] == kNoWindow) continue;
    sum += map[i];
    windows += 1.0;
  }
  quality.ssim = windows > 0.0 ? sum / windows : 1.0;
  return quality;
}

double psnr(const Picture& a, const Picture& b) {
  double squares = 0.0;
  for (std::size_t i = 0; i < a.colour.size(); ++i) {
    const glm::dvec3 difference = unpack(a.colour[i]) - unpack(b.colour[i]);
    squares += glm::dot(difference, difference);
  }
  return decibels(squares / (3.0 * static_cast<double>(a.colour.size())));
}

}  // namespace strata::test
