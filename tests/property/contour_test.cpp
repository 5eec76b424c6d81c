#include "converter/build/contour.h"

#include <gtest/gtest.h>

#include <glm/gtc/quaternion.hpp>
#include <random>

namespace strata {
namespace {

/// Points of a box with the given half sizes, turned and moved at random.
std::vector<glm::dvec3> turnedBox(std::mt19937_64& random, const glm::dvec3& half, int count) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const glm::dquat turn = glm::normalize(glm::dquat(normal(random), normal(random), normal(random), normal(random)));
  const glm::dvec3 centre(500000.0 + 1000.0 * uniform(random), 5400000.0, 30.0 * uniform(random));
  std::vector<glm::dvec3> points;
  for (int i = 0; i < count; ++i)
    points.push_back(centre + turn * (half * glm::dvec3(uniform(random), uniform(random), uniform(random))));
  return points;
}

SubtreeShape shapeOf(const std::vector<glm::dvec3>& points) {
  Moments moments;
  Box box;
  for (const glm::dvec3& p : points) {
    moments.add(p);
    box.add(p);
  }
  return fitContour(moments, box, [&](auto&& see) {
    for (const glm::dvec3& p : points) see(p);
  });
}

TEST(Contour, LinePlaneAndVolumeAreToldApartAtAnyRotation) {
  std::mt19937_64 random(1);
  for (int round = 0; round < 200; ++round) {
    EXPECT_EQ(shapeOf(turnedBox(random, {10.0, 0.01, 0.01}, 500)).contourClass, ContourClass::linear);
    EXPECT_EQ(shapeOf(turnedBox(random, {10.0, 7.0, 0.05}, 500)).contourClass, ContourClass::planar);
    EXPECT_EQ(shapeOf(turnedBox(random, {10.0, 7.0, 5.0}, 500)).contourClass, ContourClass::volumetric);
  }
}

TEST(Contour, HoldsEveryPoint) {
  std::mt19937_64 random(2);
  for (int round = 0; round < 200; ++round) {
    const glm::dvec3 half(10.0, round % 3 == 0 ? 0.0 : 5.0, round % 2 == 0 ? 0.02 : 6.0);
    const auto points = turnedBox(random, half, 1 + round);
    const SubtreeShape shape = shapeOf(points);
    for (const glm::dvec3& p : points)
      for (const glm::dvec3& axis : shape.halfAxes) {
        const double length = glm::length(axis);
        const double along = length > 0.0 ? std::abs(glm::dot(p - shape.centre, axis / length)) : 0.0;
        ASSERT_LE(along, length + 1e-6);
      }
  }
}

TEST(Contour, AFlatNodeGetsABoxAsThinAsItsPoints) {
  std::mt19937_64 random(3);
  const SubtreeShape shape = shapeOf(turnedBox(random, {10.0, 10.0, 0.01}, 3000));
  double thinnest = 1e300;
  for (const glm::dvec3& axis : shape.halfAxes) thinnest = std::min(thinnest, glm::length(axis));
  EXPECT_LT(thinnest, 0.05);
}

TEST(Moments, MergedPartsEqualTheWhole) {
  std::mt19937_64 random(4);
  const auto points = turnedBox(random, {10.0, 3.0, 1.0}, 1000);
  Moments whole, first, second;
  for (std::size_t i = 0; i < points.size(); ++i) {
    whole.add(points[i]);
    (i < 300 ? first : second).add(points[i]);
  }
  first.add(second);
  EXPECT_DOUBLE_EQ(first.count, whole.count);
  for (std::size_t k = 0; k < 6; ++k)
    EXPECT_NEAR(first.scatter[k], whole.scatter[k], 1e-6 * (1.0 + std::abs(whole.scatter[k])));
}

TEST(Contour, OnePointAndCopiesOfItHaveAnEmptyBox) {
  const SubtreeShape shape = shapeOf(std::vector<glm::dvec3>(50, glm::dvec3(3.0, 4.0, 5.0)));
  EXPECT_EQ(shape.centre, glm::dvec3(3.0, 4.0, 5.0));
  for (const glm::dvec3& axis : shape.halfAxes) EXPECT_EQ(glm::length(axis), 0.0);
}

}  // namespace
}  // namespace strata
