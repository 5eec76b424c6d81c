#include "core/view.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace strata {
namespace {

struct Pixel {
  double x, y, depth;
  bool inFront;
};

/// The place of a world position in the picture.
Pixel project(const View& view, const glm::dvec3& position) {
  const Projection p = projection(view);
  const glm::dvec4 d(position - p.eye, 1.0);
  const double w = glm::dot(p.rowW, d);
  const double depth = glm::dot(p.rowDepth, d);
  return {glm::dot(p.rowX, d) / w, glm::dot(p.rowY, d) / w, depth, depth >= view.nearPlane};
}

bool isVisible(const View& view, const glm::dvec3& position) {
  const Pixel at = project(view, position);
  return at.inFront && at.x >= 0.0 && at.x <= view.width && at.y >= 0.0 && at.y <= view.height;
}

View north() {  // looks along +y from the origin, x to the right, z up
  View view;
  view.eye = {0.0, 0.0, 0.0};
  view.target = {0.0, 1.0, 0.0};
  view.fovY = 2.0 * std::atan(0.5);  // one metre high at one metre
  view.width = 200;
  view.height = 100;
  return view;
}

View randomView(std::mt19937& random) {
  std::uniform_real_distribution<double> place(-20.0, 20.0);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  View view;
  view.eye = {place(random), place(random), place(random)};
  view.target = {place(random), place(random), place(random)};
  view.fovY = 0.2 + 2.0 * unit(random);
  view.orthographic = unit(random) < 0.3;
  view.orthographicHeight = 1.0 + 30.0 * unit(random);
  view.width = 64 + static_cast<int>(1000 * unit(random));
  view.height = 64 + static_cast<int>(1000 * unit(random));
  return view;
}

TEST(View, TheTargetLandsInTheMiddle) {
  std::mt19937 random(1);
  for (int i = 0; i < 200; ++i) {
    const View view = randomView(random);
    const Pixel at = project(view, view.target);
    EXPECT_NEAR(at.x, 0.5 * view.width, 1e-6);
    EXPECT_NEAR(at.y, 0.5 * view.height, 1e-6);
    EXPECT_NEAR(at.depth, glm::length(view.target - view.eye), 1e-9);
  }
}

TEST(View, KnownPointsLandWhereTheyShould) {
  const View view = north();
  const Pixel rightTop = project(view, {1.0, 1.0, 0.5});
  EXPECT_NEAR(rightTop.x, 200.0, 1e-9);
  EXPECT_NEAR(rightTop.y, 0.0, 1e-9);
  const Pixel farLeft = project(view, {-5.0, 10.0, -2.5});
  EXPECT_NEAR(farLeft.x, 50.0, 1e-9);
  EXPECT_NEAR(farLeft.y, 75.0, 1e-9);
  EXPECT_NEAR(farLeft.depth, 10.0, 1e-12);
}

TEST(View, AnOrthographicViewDoesNotShrinkWithDistance) {
  View view = north();
  view.orthographic = true;
  view.orthographicHeight = 4.0;
  for (const double distance : {1.0, 100.0, 10000.0}) {
    const Pixel at = project(view, {2.0, distance, 1.0});
    EXPECT_NEAR(at.x, 150.0, 1e-9);
    EXPECT_NEAR(at.y, 25.0, 1e-9);
    EXPECT_NEAR(at.depth, distance, 1e-9);
  }
}

TEST(View, UtmSizedCoordinatesLandWithinAMillionthOfAPixel) {
  const View at0 = north();
  const glm::dvec3 utm(482411.96999999997, 4390628.5, 1890.58);
  View moved = at0;
  moved.eye += utm;
  moved.target += utm;
  const Pixel a = project(at0, {0.25, 2.0, 0.125});
  const Pixel b = project(moved, utm + glm::dvec3(0.25, 2.0, 0.125));
  EXPECT_NEAR(a.x, b.x, 1e-6);
  EXPECT_NEAR(a.y, b.y, 1e-6);
}

TEST(View, TheBasisIsOrthonormalEvenWhereTheInputIsDegenerate) {
  std::mt19937 random(2);
  std::vector<View> views(3);
  views[0].eye = views[0].target;                        // no direction
  views[1].target = views[1].eye + glm::dvec3(0, 0, 5);  // straight up
  views[2].up = glm::dvec3(0.0);                         // no up
  for (int i = 0; i < 100; ++i) views.push_back(randomView(random));
  for (const View& view : views) {
    const ViewBasis basis = viewBasis(view);
    EXPECT_NEAR(glm::length(basis.forward), 1.0, 1e-12);
    EXPECT_NEAR(glm::length(basis.right), 1.0, 1e-12);
    EXPECT_NEAR(glm::length(basis.up), 1.0, 1e-12);
    EXPECT_NEAR(glm::dot(basis.forward, basis.up), 0.0, 1e-12);
    EXPECT_NEAR(glm::dot(basis.forward, basis.right), 0.0, 1e-12);
    EXPECT_GT(glm::dot(glm::cross(basis.right, basis.up), -basis.forward), 0.99) << "not right-handed";
  }
}

TEST(Frustum, APointIsInsideThePlanesExactlyWhenItLandsInTheImage) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-40.0, 40.0);
  int visible = 0;
  for (int i = 0; i < 20000; ++i) {
    const View view = randomView(random);
    const glm::dvec3 position(place(random), place(random), place(random));
    double least = 1e9;
    for (const glm::dvec4& plane : frustumPlanes(view))
      least = std::min(least, glm::dot(plane, glm::dvec4(position - view.eye, 1.0)));
    if (std::abs(least) < 1e-9) continue;
    EXPECT_EQ(least > 0.0, isVisible(view, position));
    visible += isVisible(view, position) ? 1 : 0;
  }
  EXPECT_GT(visible, 500);
}

TEST(Frustum, ABoxThatHoldsAVisiblePointIsNeverCulled) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> place(-40.0, 40.0);
  std::exponential_distribution<double> extent(0.5);
  int tried = 0, culled = 0;
  for (int i = 0; i < 40000; ++i) {
    const View view = randomView(random);
    const glm::dvec3 position(place(random), place(random), place(random));
    const glm::dvec3 lo = position - glm::dvec3(extent(random), extent(random), extent(random)) - view.eye;
    const glm::dvec3 hi = position + glm::dvec3(extent(random), extent(random), extent(random)) - view.eye;
    const bool kept = boxInFrustum(frustumPlanes(view), lo, hi);
    culled += kept ? 0 : 1;
    if (!isVisible(view, position)) continue;
    ++tried;
    EXPECT_TRUE(kept);
  }
  EXPECT_GT(tried, 1000);
  EXPECT_GT(culled, 1000) << "nothing is ever culled";
}

TEST(View, PixelsAtAgreesWithTheProjection) {
  const View view = north();
  for (const double depth : {0.5, 3.0, 70.0}) {
    const double across = project(view, {0.1, depth, 0.0}).x - project(view, {0.0, depth, 0.0}).x;
    EXPECT_NEAR(pixelsAt(view, 0.1, depth), across, 1e-9);
  }
}

TEST(View, AViewOfABoxShowsAllEightCorners) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int i = 0; i < 500; ++i) {
    Box box;
    box.add(glm::dvec3(500000.0 + 50 * unit(random), 4000000.0 + 50 * unit(random), 10 * unit(random)));
    box.add(box.min + glm::abs(glm::dvec3(100 * unit(random), 30 * unit(random), 5 * unit(random))));
    const View view = viewOfBox(box, {unit(random), unit(random), unit(random) - 1.5}, 640, 360, 0.9);
    for (int corner = 0; corner < 8; ++corner)
      EXPECT_TRUE(isVisible(view, {corner & 4 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y,
                                   corner & 1 ? box.max.z : box.min.z}));
  }
}

TEST(View, AViewOfASinglePointIsSane) {
  Box box;
  box.add(glm::dvec3(3.0, 4.0, 5.0));
  const View view = viewOfBox(box, {0.0, 1.0, -1.0}, 640, 360, 0.9);
  EXPECT_TRUE(isVisible(view, {3.0, 4.0, 5.0}));
}

}  // namespace
}  // namespace strata
