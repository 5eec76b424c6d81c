#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <random>
#include <span>
#include <vector>

#include "converter/build/local_points.h"
#include "core/box.h"

// Clouds of synthetic points, and a measure of how evenly some of them are spread.
namespace strata::test {

/// Points as integers of a grid.
struct Cloud {
  std::vector<std::int32_t> axis[3];
  glm::dvec3 step{0.001};

  LocalPoints local() const { return {{axis[0], axis[1], axis[2]}, step}; }
  glm::dvec3 position(std::size_t i) const { return step * glm::dvec3(axis[0][i], axis[1][i], axis[2][i]); }
  std::size_t count() const { return axis[0].size(); }
};

inline glm::dquat anyTurn(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return glm::normalize(glm::dquat(normal(random), normal(random), normal(random), normal(random)));
}

/// Random points in a box with the given half sizes, metres. The box is turned and lies in the middle of a cube of 2^20
/// steps.
inline Cloud turnedBox(std::mt19937_64& random, const glm::dvec3& half, std::size_t count, const glm::dquat& turn) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Cloud cloud;
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec3 p = turn * (half * glm::dvec3(uniform(random), uniform(random), uniform(random)));
    for (int a = 0; a < 3; ++a)
      cloud.axis[a].push_back(static_cast<std::int32_t>(std::lround(p[a] / cloud.step[a])) + (1 << 19));
  }
  return cloud;
}

/// The coefficient of variation of the distances to the nearest neighbour: 0.52 for random points of a plane, 0 on a
/// grid.
inline double nearestNeighbourVariation(const Cloud& cloud, std::span<const std::uint32_t> shown) {
  std::vector<glm::dvec3> points;
  Box box;
  for (const std::uint32_t i : shown) {
    points.push_back(cloud.position(i));
    box.add(points.back());
  }
  const double cell = 2.0 * box.diagonal() / std::sqrt(static_cast<double>(points.size()));
  const auto cellOf = [&](const glm::dvec3& p) {
    const glm::ivec3 c = glm::floor((p - box.min) / cell);
    return std::array<int, 3>{c.x, c.y, c.z};
  };
  std::map<std::array<int, 3>, std::vector<std::size_t>> grid;
  for (std::size_t i = 0; i < points.size(); ++i) grid[cellOf(points[i])].push_back(i);
  double sum = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    double best = 1e300;
    const auto [x, y, z] = cellOf(points[i]);
    for (int n = 0; n < 27; ++n)
      if (const auto found = grid.find({x + n / 9 - 1, y + n / 3 % 3 - 1, z + n % 3 - 1}); found != grid.end())
        for (const std::size_t j : found->second)
          if (j != i) best = std::min(best, glm::length(points[i] - points[j]));
    sum += best;
    squares += best * best;
  }
  const double mean = sum / static_cast<double>(points.size());
  return std::sqrt(std::max(0.0, squares / static_cast<double>(points.size()) - mean * mean)) / mean;
}

/// The largest variation at the ends of levels, and that at any of a series of prefixes.
struct Evenness {
  double fullLevels = 0.0, anywhere = 0.0;
};
inline Evenness evennessOf(const Cloud& cloud, std::span<const std::uint32_t> order,
                           std::span<const std::uint32_t> prefix) {
  Evenness worst;
  for (std::size_t l = 0; l + 1 < prefix.size(); ++l)
    if (prefix[l] >= 200)
      worst.fullLevels = std::max(worst.fullLevels, nearestNeighbourVariation(cloud, order.first(prefix[l])));
  for (std::size_t n = 200; n <= order.size(); n += n / 7 + 1)
    worst.anywhere = std::max(worst.anywhere, nearestNeighbourVariation(cloud, order.first(n)));
  return worst;
}

}  // namespace strata::test
