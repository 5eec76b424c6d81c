#include "render/plan/batch_plan.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/synthetic_nodes.h"

namespace strata {
namespace {

const glm::dvec3 kUtm(456789.123, 5412345.678, 312.5);

std::vector<glm::dvec3> cube(std::uint32_t count, double side, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0.0, side);
  std::vector<glm::dvec3> points(count);
  for (glm::dvec3& p : points) p = kUtm + glm::dvec3(unit(random), unit(random), unit(random));
  return points;
}

glm::dvec2 pixelOf(const Projection& p, const glm::dvec3& position) {
  const glm::dvec4 d(position - p.eye, 1.0);
  return glm::dvec2(glm::dot(p.rowX, d), glm::dot(p.rowY, d)) / glm::dot(p.rowW, d);
}

TEST(BatchPlan, MovesNoVisiblePointByMoreThanHalfAPixelWhateverThePrecision) {
  const auto node = test::makeNode({}, cube(20000, 10.0, 1), 1e-8, 500);
  ASSERT_EQ(node->loadedPlanes(), 3);
  int used[3] = {};
  for (const View& view : test::viewsAround(test::boundsOf(test::makeList({node})), 24, 1920, 1080)) {
    for (const double away : {0.2, 1.0, 3.0, 20.0}) {
      View moved = view;
      moved.eye = view.target + (view.eye - view.target) * away;
      const ViewConstants constants = viewConstants(moved);
      for (const Batch& batch : node->batches) {
        const Precision precision = batchPrecision(constants, *node, batch);
        ++used[static_cast<int>(precision) - 1];
        for (std::uint32_t i = batch.firstPoint; i < batch.firstPoint + batch.pointCount; ++i) {
          const glm::dvec3 exact = pointPosition(*node, batch, i, Precision::full30);
          const glm::dvec2 wanted = pixelOf(constants.projection, exact);
          const bool seen =
              glm::dot(constants.projection.rowDepth, glm::dvec4(exact - moved.eye, 1.0)) > moved.nearPlane &&
              wanted.x >= 0.0 && wanted.y >= 0.0 && wanted.x < moved.width && wanted.y < moved.height;
          if (!seen) continue;
          const glm::dvec2 found = pixelOf(constants.projection, pointPosition(*node, batch, i, precision));
          ASSERT_LE(glm::distance(wanted, found), 0.5);
        }
      }
    }
  }
  EXPECT_GT(used[0], 0);
  EXPECT_GT(used[1], 0);
}

TEST(BatchPlan, ReadsThirtyBitsOnlyWhereTheEyeIsAtTheBatch) {
  const auto node = test::makeNode({}, cube(5000, 10.0, 2), 1e-8);
  View view;
  view.width = 1920;
  view.height = 1080;
  const glm::dvec3 centre = kUtm + 5.0;
  const auto precisionAt = [&](double distance) {
    view.eye = centre - glm::dvec3(0.0, distance, 0.0);
    view.target = centre;
    return batchPrecision(viewConstants(view), *node, node->batches.front());
  };
  EXPECT_EQ(precisionAt(0.0), Precision::full30);
  EXPECT_EQ(precisionAt(20.0), Precision::medium20);
  EXPECT_EQ(precisionAt(1000.0), Precision::low10);
}

TEST(BatchPlan, ReadsNoMorePlanesThanAreLoadedOrFilled) {
  const std::vector<glm::dvec3> points = cube(5000, 10.0, 3);
  View view;
  view.eye = kUtm + 5.0;
  view.target = kUtm + glm::dvec3(5.0, 6.0, 5.0);
  const ViewConstants constants = viewConstants(view);
  const auto precisionOf = [&](double step, int planes) {
    const auto node = test::makeNode({}, points, step, Batch::kMaxPoints, planes);
    return batchPrecision(constants, *node, node->batches.front());
  };
  EXPECT_EQ(precisionOf(1e-8, 3), Precision::full30);
  EXPECT_EQ(precisionOf(1e-8, 2), Precision::medium20);
  EXPECT_EQ(precisionOf(1e-8, 1), Precision::low10);
  EXPECT_EQ(precisionOf(1e-3, 3), Precision::medium20);
  EXPECT_EQ(precisionOf(2e-2, 3), Precision::low10);
}

TEST(BatchPlan, CullsNoBatchWithAPointInTheImage) {
  const RenderList list = test::makeTown(kUtm, 100.0, 20000, 4, 6);
  for (const View& view : test::viewsAround(test::boundsOf(list), 16, 640, 480)) {
    DrawPlan plan;
    planBatches(list, view, {}, plan);
    EXPECT_GT(plan.batches.size() + plan.batchesCulled, 0u);
    std::uint32_t firstId = 0;
    std::size_t next = 0;
    for (const RenderItem& item : list.items) {
      for (const Batch& batch : item.node->batches) {
        const bool planned = next < plan.batches.size() && plan.batches[next].firstId == firstId + batch.firstPoint;
        next += planned;
        if (planned) continue;
        for (std::uint32_t i = batch.firstPoint; i < batch.firstPoint + batch.pointCount; ++i) {
          const glm::dvec3 position = pointPosition(*item.node, batch, i, Precision::medium20);
          const glm::dvec2 pixel = pixelOf(plan.constants.projection, position);
          const double depth = glm::dot(plan.constants.projection.rowDepth, glm::dvec4(position - view.eye, 1.0));
          EXPECT_FALSE(depth >= view.nearPlane && pixel.x >= 0.0 && pixel.y >= 0.0 && pixel.x < 640.0 &&
                       pixel.y < 480.0);
        }
      }
      firstId += item.pointCount;
    }
    EXPECT_EQ(next, plan.batches.size());
  }
}

TEST(BatchPlan, CutsBatchesToThePrefixOfTheItem) {
  RenderList list = test::makeList({test::makeNode({}, cube(1000, 10.0, 5), 1e-3, 300)});
  const View view = viewOfBox(test::boundsOf(list), {1.0, 0.83, -0.71}, 640, 480, 1.0);
  list.items[0].pointCount = 450;
  DrawPlan plan;
  planBatches(list, view, {}, plan);
  ASSERT_EQ(plan.batches.size(), 2u);
  EXPECT_EQ(plan.batches[0].pointCount, 300u);
  EXPECT_EQ(plan.batches[1].pointCount, 150u);
  EXPECT_EQ(plan.pointCount, 450u);
  list.items[0].pointCount = 5000;  // more than the node has
  planBatches(list, view, {}, plan);
  EXPECT_EQ(plan.pointCount, 1000u);
}

TEST(BatchPlan, SurvivesBoxesThatAreNotFinite) {
  const auto good = test::makeNode({}, cube(100, 10.0, 6), 1e-3);
  const View view = viewOfBox(test::boundsOf(test::makeList({good})), {1.0, 0.83, -0.71}, 640, 480, 1.0);
  for (const double bad : {std::nan(""), 1e300, -1e300, std::numeric_limits<double>::infinity()}) {
    auto node = std::make_shared<NodeData>(*good);
    node->batches[0].boxMin.x = bad;
    node->batches[0].boxSize.y = std::abs(bad);
    DrawPlan plan;
    planBatches(test::makeList({node, good}), view, {}, plan);
    EXPECT_EQ(plan.batches.size(), 1u);
  }
}

}  // namespace
}  // namespace strata
