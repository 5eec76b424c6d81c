#include "converter/build/local_points.h"

#include <algorithm>
#include <array>

#include "converter/memory/vector4.h"

namespace strata {
namespace {

constexpr std::size_t kLanes = 4;
constexpr std::size_t kBlock = 512;  // points whose sums stay in single precision

/// Sums of x, y, z, xx, xy, xz, yy, yz, zz.
using Sums = std::array<double, 9>;

/// `count` is a multiple of four.
void addBlock(const LocalPoints& points, std::size_t first, std::size_t count, const glm::ivec3& middle, Sums& sums) {
  Float4 s[9] = {};
  for (std::size_t i = first; i < first + count; i += kLanes) {
    const Float4 x = toFloats(loadInts(points.axis[0].data() + i) - middle.x);
    const Float4 y = toFloats(loadInts(points.axis[1].data() + i) - middle.y);
    const Float4 z = toFloats(loadInts(points.axis[2].data() + i) - middle.z);
    s[0] += x;
    s[1] += y;
    s[2] += z;
    s[3] += x * x;
    s[4] += x * y;
    s[5] += x * z;
    s[6] += y * y;
    s[7] += y * z;
    s[8] += z * z;
  }
  for (std::size_t k = 0; k < sums.size(); ++k)
    for (std::size_t lane = 0; lane < kLanes; ++lane) sums[k] += static_cast<double>(s[k][lane]);
}

void addOne(const LocalPoints& points, std::size_t i, const glm::ivec3& middle, Sums& sums) {
  const double x = points.axis[0][i] - middle.x, y = points.axis[1][i] - middle.y, z = points.axis[2][i] - middle.z;
  const double terms[9] = {x, y, z, x * x, x * y, x * z, y * y, y * z, z * z};
  for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += terms[k];
}

}  // namespace

LocalBounds boundsOf(const LocalPoints& points) {
  LocalBounds bounds;
  for (int axis = 0; axis < 3; ++axis) {
    std::int32_t low = points.axis[axis][0], high = low;
    for (const std::int32_t v : points.axis[axis]) {
      low = std::min(low, v);
      high = std::max(high, v);
    }
    bounds.low[axis] = low;
    bounds.high[axis] = high;
  }
  return bounds;
}

Moments momentsOf(const LocalPoints& points, const LocalBounds& bounds) {
  const glm::ivec3 middle = bounds.low + (bounds.high - bounds.low) / 2;
  const std::size_t whole = points.count() / kLanes * kLanes;
  Sums sums{};
  for (std::size_t first = 0; first < whole; first += kBlock)
    addBlock(points, first, std::min(kBlock, whole - first), middle, sums);
  for (std::size_t i = whole; i < points.count(); ++i) addOne(points, i, middle, sums);

  Moments moments;
  moments.count = static_cast<double>(points.count());
  const glm::dvec3 sum(sums[0], sums[1], sums[2]);
  moments.mean = (glm::dvec3(middle) + sum / moments.count) * points.step;
  constexpr int kPairs[6][2] = {{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}};
  for (std::size_t k = 0; k < 6; ++k) {
    const auto [a, b] = kPairs[k];
    moments.scatter[k] = (sums[3 + k] - sum[a] * sum[b] / moments.count) * points.step[a] * points.step[b];
  }
  return moments;
}

}  // namespace strata
