#include "lod/selection.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "lod/hierarchy_index.h"
#include "tests/support/lod_store.h"

namespace strata {
namespace {

using test::makeTerrain;
using test::Terrain;
using test::TerrainOptions;
using test::viewOfTerrain;

/// Wants one point per pixel unless told otherwise, which makes for plain numbers.
Selection select(const Hierarchy& hierarchy, const View& view,
                 const SelectionOptions& options = {.pointsPerPixel = 1.0}) {
  Selection selection;
  selectNodes(hierarchy, view, options, selection);
  return selection;
}

/// A hierarchy of one node, a box with these half sizes around the origin.
Hierarchy oneBox(glm::vec3 half, std::uint32_t points, ContourClass kind, float spacing) {
  NodeRecord record{};
  record.key = 1;
  record.pointCount = points;
  record.contourClass = static_cast<std::uint8_t>(kind);
  record.spacing = spacing;
  for (int a = 0; a < 3; ++a) record.halfAxis[a][a] = half[a];
  return Hierarchy{{record}};
}

View from(const glm::dvec3& eye) {
  View view;
  view.eye = eye;
  view.target = glm::dvec3(0.0);
  return view;
}

TEST(Selection, IsEmptyForAnEmptyHierarchy) {
  const Selection selection = select(Hierarchy{}, View{});
  EXPECT_TRUE(selection.nodes.empty());
  EXPECT_EQ(selection.pointCount, 0u);
}

TEST(Selection, IsEmptyWhenLookingAway) {
  const Terrain terrain = makeTerrain({}, false);
  View view = viewOfTerrain(terrain.info, 0.5, 0.5, 50.0);
  view.target = view.eye + glm::dvec3(0.0, 0.0, 10.0);
  EXPECT_TRUE(select(terrain.hierarchy, view).nodes.empty());
}

TEST(Selection, IsEveryWholeNodeWhenAllIsInViewAndEverythingIsAskedFor) {
  const Terrain terrain = makeTerrain({}, false);
  const View view = viewOfBox(terrain.info.rootCube(), {0.2, 0.3, -1.0}, 1920, 1080, 1.0);
  SelectionOptions options{.pointsPerPixel = 1.0};
  options.pointsPerPixel = 1e9;
  options.pointBudget = SelectionOptions::kMaxPointBudget;
  const Selection selection = select(terrain.hierarchy, view, options);
  EXPECT_EQ(selection.nodes.size(), terrain.hierarchy.nodes.size());
  EXPECT_EQ(selection.pointCount, terrain.info.points);
}

TEST(Selection, GivesFewerPointsToWhatIsFartherAway) {
  const Hierarchy wall = oneBox({10, 0.05f, 10}, 1'000'000, ContourClass::planar, 0.02f);
  const Selection near = select(wall, from({0, -50, 0}));
  const Selection far = select(wall, from({0, -500, 0}));
  ASSERT_EQ(near.nodes.size(), 1u);
  ASSERT_EQ(far.nodes.size(), 1u);
  EXPECT_NEAR(static_cast<double>(near.pointCount), 100.0 * static_cast<double>(far.pointCount),
              0.02 * static_cast<double>(near.pointCount));
}

TEST(Selection, GivesAsManyPointsAsPixelsToAWallThatIsSeenFaceOn) {
  const Hierarchy wall = oneBox({10, 0.0f, 10}, 1'000'000, ContourClass::planar, 0.02f);
  const View view = from({0, -50, 0});
  const double sidePx = pixelsAt(view, 20.0, 50.0);
  EXPECT_NEAR(static_cast<double>(select(wall, view).pointCount), sidePx * sidePx, 0.01 * sidePx * sidePx);
  SelectionOptions half{.pointsPerPixel = 1.0};
  half.pointsPerPixel = 0.5;
  EXPECT_NEAR(static_cast<double>(select(wall, view, half).pointCount), 0.5 * sidePx * sidePx, 0.01 * sidePx * sidePx);
}

TEST(Selection, GivesAWallSeenEdgeOnAtMostAFifthOfOneSeenFaceOn) {
  const Hierarchy wall = oneBox({10, 0.05f, 10}, 1'000'000, ContourClass::planar, 0.02f);
  const Selection face = select(wall, from({0, -50, 0}));
  const Selection edge = select(wall, from({50, 0, 0}));
  ASSERT_EQ(edge.nodes.size(), 1u) << "it is in view all the same";
  EXPECT_LE(edge.pointCount * 5, face.pointCount);
}

TEST(Selection, DrawsAWallNearTheEyeWhole) {
  const Hierarchy wall = oneBox({10, 0.05f, 10}, 1'000'000, ContourClass::planar, 0.02f);
  EXPECT_EQ(select(wall, from({0, -1, 0})).pointCount, 1'000'000u);
}

TEST(Selection, GivesALineAPointForEachPixelOfItsLength) {
  const Hierarchy wire = oneBox({10, 0, 0}, 20'000, ContourClass::linear, 0.001f);
  const View view = from({0, -50, 0});
  const double lengthPx = pixelsAt(view, 20.0, 50.0);
  EXPECT_NEAR(static_cast<double>(select(wire, view).pointCount), lengthPx, 0.05 * lengthPx);
}

TEST(Selection, CountsALongStripAsAnAreaWhateverItsSpacingSays) {
  // A road of 400 m by 40 m is linear by Kanzok's thresholds; its points lie 0.5 m apart, not in one row.
  Hierarchy road = oneBox({200, 20, 1}, 64'000, ContourClass::linear, 400.0f / 64'000);
  road.nodes[0].childMask = 1;
  road.nodes[0].firstChild = 1;
  NodeRecord child = road.nodes[0];
  child.key = 8;
  child.childMask = 0;
  road.nodes.push_back(child);
  View view = from({0, 0, 100});
  view.up = {0, 1, 0};
  const Selection selection = select(road, view);
  EXPECT_EQ(selection.nodes.size(), 2u);
  EXPECT_EQ(selection.pointCount, 128'000u);
}

TEST(Selection, HoldsTheBudgetExactlyAndSaysSo) {
  const Terrain terrain = makeTerrain({.levels = 6}, false);
  const View view = viewOfTerrain(terrain.info, 0.5, 0.3, 100.0);
  const Selection free = select(terrain.hierarchy, view);
  ASSERT_GT(free.pointCount, 5000u);
  EXPECT_FALSE(free.budgetReached);
  for (const std::uint64_t budget : {std::uint64_t{1}, std::uint64_t{777}, free.pointCount - 1}) {
    SelectionOptions options{.pointsPerPixel = 1.0};
    options.pointBudget = budget;
    const Selection cut = select(terrain.hierarchy, view, options);
    EXPECT_EQ(cut.pointCount, budget);
    EXPECT_TRUE(cut.budgetReached);
  }
  SelectionOptions none{.pointsPerPixel = 1.0};
  none.pointBudget = 0;
  EXPECT_TRUE(select(terrain.hierarchy, view, none).nodes.empty());
}

TEST(Selection, UnderABudgetIsThatOfALowerDensity) {
  const Terrain terrain = makeTerrain({.levels = 6}, false);
  const View view = viewOfTerrain(terrain.info, 0.5, 0.3, 100.0);
  SelectionOptions options{.pointsPerPixel = 1.0};
  options.pointsPerPixel = 8.0;
  options.pointBudget = select(terrain.hierarchy, view, options).pointCount / 3;
  const Selection cut = select(terrain.hierarchy, view, options);
  ASSERT_LT(cut.pointsPerPixel, options.pointsPerPixel);

  SelectionOptions thinner{.pointsPerPixel = 1.0};
  thinner.pointsPerPixel = cut.pointsPerPixel;
  const Selection thin = select(terrain.hierarchy, view, thinner);
  ASSERT_EQ(cut.nodes.size(), thin.nodes.size());
  EXPECT_GT(static_cast<double>(thin.pointCount), 0.995 * static_cast<double>(options.pointBudget));
  std::map<std::uint32_t, std::uint32_t> points;
  for (const SelectedNode& node : thin.nodes) points[node.node] = node.pointCount;
  for (const SelectedNode& node : cut.nodes) {
    ASSERT_TRUE(points.contains(node.node));
    EXPECT_GE(node.pointCount, points[node.node]);  // what the density leaves of the budget is handed out
  }
}

TEST(Selection, ChangesLittleWhenTheBudgetDoes) {
  const Terrain terrain = makeTerrain({.levels = 6}, false);
  const View view = viewOfTerrain(terrain.info, 0.5, 0.3, 100.0);
  SelectionOptions options{.pointsPerPixel = 1.0};
  options.pointsPerPixel = 16.0;
  const std::uint64_t most = select(terrain.hierarchy, view, options).pointCount;
  const std::uint32_t whole = terrain.hierarchy.nodes[0].pointCount;
  std::map<std::uint32_t, std::uint32_t> before;
  for (double budget = 2000.0; budget < static_cast<double>(most); budget *= 1.01) {
    options.pointBudget = static_cast<std::uint64_t>(budget);
    const Selection selection = select(terrain.hierarchy, view, options);
    std::map<std::uint32_t, std::uint32_t> now;
    for (const SelectedNode& node : selection.nodes) {
      now[node.node] = node.pointCount;
      const std::uint32_t last = before.contains(node.node) ? before[node.node] : 0;
      if (!before.empty()) {
        EXPECT_LT(node.pointCount, last + 0.1 * whole + 0.002 * budget) << budget;
      }
    }
    before = std::move(now);
  }
}

TEST(Selection, AsksForFewerBitsFarAway) {
  const Hierarchy box = oneBox({1, 1, 1}, 1000, ContourClass::volumetric, 0.1f);
  EXPECT_EQ(select(box, from({0, -100, 0})).nodes.at(0).precision, Precision::low10);
  EXPECT_EQ(select(box, from({0, -3, 0})).nodes.at(0).precision, Precision::medium20);
  EXPECT_EQ(select(box, from({0, -0.5, 0})).nodes.at(0).precision, Precision::medium20);
}

TEST(Selection, TakesAMillionCopiesOfOnePointForOnePixel) {
  Hierarchy copies = oneBox({0, 0, 0}, 1'000'000, ContourClass::linear, 0.0f);
  copies.nodes[0].childMask = 1;
  copies.nodes[0].firstChild = 1;
  NodeRecord child = copies.nodes[0];
  child.key = 8;
  child.childMask = 0;
  child.firstChild = 0;
  copies.nodes.push_back(child);
  const Selection selection = select(copies, from({0, -3, 0}));
  ASSERT_EQ(selection.nodes.size(), 1u);
  EXPECT_EQ(selection.pointCount, 1u);
}

TEST(Selection, BearsNonsenseInRecordsAndViews) {
  Terrain terrain = makeTerrain({.levels = 3}, false);
  const double nan = std::nan("");
  terrain.hierarchy.nodes[1].spacing = static_cast<float>(nan);
  terrain.hierarchy.nodes[2].centre[0] = nan;
  terrain.hierarchy.nodes[3].firstChild = 1;  // a cycle
  terrain.hierarchy.nodes[4].firstChild = 1u << 30;
  View view = viewOfTerrain(terrain.info, 0.5, 0.5, 10.0);
  EXPECT_LE(select(terrain.hierarchy, view).nodes.size(), terrain.hierarchy.nodes.size());
  view.width = 0;
  view.height = 0;
  select(terrain.hierarchy, view);
  view.target = view.eye = glm::dvec3(nan);
  select(terrain.hierarchy, view);
}

TEST(Selection, FindsAPoleThatSticksOutOfTheGroundAboveIt) {
  // The ground's own points are flat; its child is a pole of 10 m. The view shows the pole's top only.
  Hierarchy hierarchy = oneBox({50, 50, 0.05f}, 10'000, ContourClass::planar, 1.0f);
  hierarchy.nodes[0].childMask = 1;
  hierarchy.nodes[0].firstChild = 1;
  NodeRecord pole = oneBox({0.1f, 0.1f, 5}, 1000, ContourClass::linear, 0.01f).nodes[0];
  pole.key = 8;
  pole.centre[2] = 5.0;
  hierarchy.nodes.push_back(pole);
  View view;
  view.eye = {0, -5, 8};
  view.target = {0, 0, 9};
  view.fovY = 0.3;

  EXPECT_TRUE(select(hierarchy, view).nodes.empty());
  const HierarchyIndex index = indexHierarchy(hierarchy);
  Selection selection;
  selectNodes({hierarchy, index.reach}, view, {}, selection);
  ASSERT_EQ(selection.nodes.size(), 2u);
  EXPECT_EQ(selection.nodes[1].node, 1u);
}

TEST(HierarchyIndex, KnowsParentsAndGrowsContoursOverAllBelow) {
  const Terrain terrain = makeTerrain({.levels = 5}, false);
  const HierarchyIndex index = indexHierarchy(terrain.hierarchy);
  EXPECT_EQ(index.parent, test::parentsOf(terrain.hierarchy));
  for (const float reach : index.reach) EXPECT_LT(reach, 1e-3f) << "the children of this ground lie inside it";
}

TEST(Selection, AllocatesNothingWhenItIsUsedAgain) {
  const Terrain terrain = makeTerrain({.levels = 6}, false);
  const View view = viewOfTerrain(terrain.info, 0.5, 0.3, 100.0);
  Selection selection;
  selectNodes(terrain.hierarchy, view, {}, selection);
  const auto* nodes = selection.nodes.data();
  const auto* heap = selection.heap.data();
  const std::size_t room = selection.nodes.capacity();
  selectNodes(terrain.hierarchy, view, {}, selection);
  EXPECT_EQ(selection.nodes.data(), nodes);
  EXPECT_EQ(selection.heap.data(), heap);
  EXPECT_EQ(selection.nodes.capacity(), room);
}

}  // namespace
}  // namespace strata
