// Points at the same position tie, whatever node, batch and precision they come from, and the lowest id is seen.
#include <gtest/gtest.h>

#include <map>
#include <random>
#include <tuple>

#include "render/create_rasterizer.h"
#include "render/plan/batch_plan.h"
#include "tests/support/oracle.h"
#include "tests/support/synthetic_nodes.h"

namespace strata {
namespace {

const glm::dvec3 kUtm(456789.0, 5412345.0, 312.0);
constexpr double kStep = 0.01;

using Nodes = std::vector<std::shared_ptr<const NodeData>>;
using GridPoint = std::tuple<long long, long long, long long>;

/// Makes `nodes` nodes that share a few thousand positions, in batches of many sizes. Some nodes reach far beyond these
/// positions, so that their batches have other bits and other corners.
Nodes sharedPlaces(std::uint32_t seed, int nodes, double side) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const auto onGrid = [](double x) { return std::round(x / kStep) * kStep; };
  std::vector<glm::dvec3> places(4000);
  for (glm::dvec3& p : places)
    p = kUtm + glm::dvec3(onGrid(side * unit(random)), onGrid(side * unit(random)), onGrid(side * unit(random)));
  Nodes made;
  for (int n = 0; n < nodes; ++n) {
    std::vector<glm::dvec3> points;
    for (const glm::dvec3& p : places)
      if (unit(random) < 0.6) points.push_back(p);
    const double reach = side * std::exp2(static_cast<double>(n % 5));
    for (int i = 0; i < 50 * (n % 3); ++i) points.push_back(kUtm + reach * (unit(random) - 0.5));
    std::shuffle(points.begin(), points.end(), random);
    const std::uint32_t batchPoints[] = {10240, 700, 64, 1};
    made.push_back(test::makeNode(NodeKey{}.child(n % 8), points, kStep, batchPoints[n % 4]));
  }
  return made;
}

GridPoint placed(const RenderList& list, const ViewConstants& constants, std::uint32_t id) {
  for (const RenderItem& item : list.items) {
    if (id >= item.pointCount) {
      id -= item.pointCount;
      continue;
    }
    const NodeData& node = *item.node;
    for (const Batch& batch : node.batches) {
      if (id >= batch.firstPoint + batch.pointCount) continue;
      // A cell of one step has its middle at half a step.
      const glm::dvec3 p = pointPosition(node, batch, id, batchPrecision(constants, node, batch)) - kUtm;
      return {std::llround(2.0 * p.x / kStep), std::llround(2.0 * p.y / kStep), std::llround(2.0 * p.z / kStep)};
    }
  }
  return {};
}

std::map<GridPoint, std::uint32_t> lowestIds(const RenderList& list, const ViewConstants& constants) {
  std::map<GridPoint, std::uint32_t> lowest;
  for (std::uint32_t id = 0; id < list.pointCount; ++id) lowest.try_emplace(placed(list, constants, id), id);
  return lowest;
}

Picture drawn(const RenderList& list, const View& view) {
  Picture picture;
  createRasterizer(Backend::cpu, {}, nullptr)->draw(list, view, {}, picture);
  return picture;
}

TEST(Ties, GoToTheLowestIdOfAllPointsOfThePlace) {
  for (const double side : {3.0, 40.0, 2000.0}) {
    const RenderList list = test::makeList(sharedPlaces(1, 7, side));
    const Box box{kUtm, kUtm + side};
    for (const View& view : test::viewsAround(box, 8, 400, 400)) {
      const auto lowest = lowestIds(list, viewConstants(view));
      const Picture picture = drawn(list, view);
      std::size_t covered = 0, shared = 0;
      for (const std::uint32_t id : picture.pointId) {
        if (id == Picture::kNoPoint) continue;
        ++covered;
        shared += lowest.at(placed(list, viewConstants(view), id)) != id;
      }
      EXPECT_GT(covered, 10u);
      EXPECT_EQ(shared, 0u) << "of " << covered << " pixels, side " << side;
    }
  }
}

TEST(Ties, GiveTheOraclesPicture) {
  for (std::uint32_t seed = 2; seed < 6; ++seed) {
    const RenderList list = test::makeList(sharedPlaces(seed, 5, 25.0));
    for (const View& view : test::viewsAround({kUtm, kUtm + 25.0}, 8, 512, 512)) {
      const test::Comparison result = test::compareToOracle(list, view, drawn(list, view));
      EXPECT_GE(result.agreement(), 0.999) << result.different << " of " << result.covered << " pixels differ";
      EXPECT_EQ(result.unexplained, 0u) << result.firstUnexplained;
    }
  }
}

TEST(Ties, DoNotMoveADepthWhenTheNodesChangePlaces) {
  Nodes nodes = sharedPlaces(7, 6, 25.0);
  const RenderList list = test::makeList(nodes);
  std::reverse(nodes.begin(), nodes.end());
  const RenderList reversed = test::makeList(nodes);
  for (const View& view : test::viewsAround({kUtm, kUtm + 25.0}, 8, 512, 512))
    EXPECT_EQ(drawn(list, view).depth, drawn(reversed, view).depth);
}

/// 400 km from the eye, steps do not fit a float and integers take over. The points of a batch that is drawn alone
/// still have the same bits as when all batches are drawn.
TEST(Ties, HoldWhereStepsOutgrowAFloat) {
  const RenderList list = test::makeList(sharedPlaces(8, 6, 200.0));
  View view = viewOfBox({kUtm, kUtm + 200.0}, {1.0, 0.83, -0.71}, 300, 300, 1.0);
  view.orthographic = true;
  view.orthographicHeight = 150.0;
  view.eye = view.target + (view.eye - view.target) * (400000.0 / glm::distance(view.eye, view.target));
  const auto lowest = lowestIds(list, viewConstants(view));
  std::size_t covered = 0;
  for (const std::uint32_t id : drawn(list, view).pointId) {
    if (id == Picture::kNoPoint) continue;
    ++covered;
    EXPECT_EQ(lowest.at(placed(list, viewConstants(view), id)), id);
  }
  EXPECT_GT(covered, 1000u);
}

}  // namespace
}  // namespace strata
