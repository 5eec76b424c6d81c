#include "viewer/bench/screen_spacing.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/lod_store.h"

namespace strata {
namespace {

/// The widest spacing when all nodes are drawn whole, except that of the last one only `last` points are.
double spacingWithLast(const test::Terrain& terrain, std::uint32_t last) {
  const View view = test::viewOfTerrain(terrain.info, 0.25, 0.05, 400.0);
  Picture open;  // nothing in it hides anything
  open.width = view.width;
  open.height = view.height;
  open.depth.assign(static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height),
                    std::numeric_limits<float>::infinity());
  RenderList list;
  for (std::uint32_t i = 0; i < terrain.hierarchy.nodes.size(); ++i) {
    auto node = std::make_shared<NodeData>();
    node->key = NodeKey{terrain.hierarchy.nodes[i].key};
    const bool isLast = i + 1 == terrain.hierarchy.nodes.size();
    const std::uint32_t points = isLast ? last : terrain.hierarchy.nodes[i].pointCount;
    if (points > 0) list.items.push_back({node, points, i});
  }
  return widestSpacing(terrain.hierarchy, indexHierarchy(terrain.hierarchy), list, view, open);
}

TEST(ScreenSpacing, IsNothingWhereEveryPointIsDrawn) {
  const test::Terrain terrain = test::makeTerrain({.levels = 2}, false);
  EXPECT_EQ(spacingWithLast(terrain, 256), 0.0);
  EXPECT_EQ(spacingWithLast(test::addSlice(terrain, 1), 256), 0.0);
}

TEST(ScreenSpacing, DrawingMoreOfASliceNarrowsIt) {
  const test::Terrain terrain = test::addSlice(test::makeTerrain({.levels = 2}, false), 1);
  ASSERT_EQ(terrain.hierarchy.nodes[1].key, terrain.hierarchy.nodes.back().key);
  double before = spacingWithLast(terrain, 0);
  EXPECT_GT(before, 0.0);
  for (const std::uint32_t points : {64u, 128u, 255u}) {
    const double spacing = spacingWithLast(terrain, points);
    EXPECT_GT(spacing, 0.0);
    EXPECT_LT(spacing, before) << points;
    before = spacing;
  }
}

}  // namespace
}  // namespace strata
