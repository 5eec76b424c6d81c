#include "viewer/tools/node_shapes.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/lod_store.h"
#include "viewer/camera/camera_control.h"

namespace strata {
namespace {

TEST(NodeShapes, AContoursEdgesLieOnItsFacesAndHaveItsSides) {
  const test::Terrain terrain = test::makeTerrain({.levels = 3}, false);
  for (const NodeRecord& record : terrain.hierarchy.nodes) {
    const std::vector<Edge> edges = contourEdges(record);
    ASSERT_EQ(edges.size(), 12u);
    double length = 0.0, expected = 0.0;
    for (const auto& [a, b] : edges) length += glm::distance(a, b);
    for (const auto& half : record.halfAxis) expected += 8.0 * glm::length(glm::dvec3(half[0], half[1], half[2]));
    EXPECT_NEAR(length, expected, 1e-6 * expected);
  }
}

TEST(NodeShapes, AFrustumsFarRectangleFillsThePicture) {
  for (const bool orthographic : {false, true}) {
    View view;
    view.eye = {630000.0, 4850000.0, 100.0};
    view.target = view.eye + glm::dvec3(10.0, 20.0, -5.0);
    view.orthographic = orthographic;
    view.orthographicHeight = 30.0;
    int corners = 0;
    for (const auto& [a, b] : frustumEdges(view, 25.0)) {
      EXPECT_NEAR(depthOf(view, b), 25.0, 1e-6);
      const glm::dvec2 pixel = pixelOf(view, b);
      const bool atX = std::abs(pixel.x) < 1e-3 || std::abs(pixel.x - view.width) < 1e-3;
      const bool atY = std::abs(pixel.y) < 1e-3 || std::abs(pixel.y - view.height) < 1e-3;
      corners += atX && atY ? 1 : 0;
    }
    EXPECT_EQ(corners, 8);
  }
}

TEST(NodeShapes, TheCoarseDepthIsBrightWhereItIsNearAndDarkWhereItIsOpen) {
  std::vector<float> depths(16, std::numeric_limits<float>::infinity());
  depths[3] = 5.0f;
  depths[7] = 50.0f;
  Picture picture;
  drawCoarseDepth(depths, picture);
  EXPECT_EQ(picture.width, 4);
  EXPECT_EQ(picture.colour[3] & 255u, 255u);
  EXPECT_EQ(picture.colour[7] & 255u, 70u);
  EXPECT_LT(picture.colour[0] & 255u, 70u);
  depths.assign(16, std::numeric_limits<float>::infinity());
  drawCoarseDepth(depths, picture);  // nothing hides anything
  EXPECT_LT(picture.colour[3] & 255u, 70u);
}

}  // namespace
}  // namespace strata
