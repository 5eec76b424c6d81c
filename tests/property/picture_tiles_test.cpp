// A picture drawn in tiles equals the picture drawn whole, in its pixels and in the nodes and points chosen for it.
#include "render/plan/picture_tiles.h"
#include "render/create_rasterizer.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

#include "lod/contour.h"
#include "lod/selection.h"
#include "tests/support/lod_store.h"
#include "tests/support/synthetic_nodes.h"
#include "tests/support/tiled_picture.h"

namespace strata {
namespace {

TEST(PictureTiles, MakeTheWholePixelForPixelWithEveryEffect) {
  const auto rasterizer = createRasterizer(Backend::cpu, {}, nullptr);
  test::expectTilesMakeTheWhole(*rasterizer, 6);
}

TEST(PictureTiles, WithoutTheirMarginShowSeams) {
  const auto rasterizer = createRasterizer(Backend::cpu, {}, nullptr);
  const RenderList list = test::makeTown({0.0, 0.0, 0.0}, 120.0, 60000, 7, 4);
  const View view = test::viewsAround(test::boundsOf(list), 1, 333, 251).front();
  for (const auto& [name, options] : test::effectsOnPictures(list)) {
    if (!options.edl && options.fill == 1 && options.pointSize == 1 && options.pointMetres == 0.0f) continue;
    Picture whole;
    rasterizer->draw(list, view, options, whole);
    EXPECT_NE(test::drawnInTiles(*rasterizer, list, view, options, {0, 1}).pixels, whole.colour) << name;
  }
}

TEST(PictureTiles, ProjectLikeTheWhole) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int round = 0; round < 500; ++round) {
    View view;
    view.eye = {630000.0 + 100.0 * unit(random), 4850000.0 + 100.0 * unit(random), 50.0 * unit(random)};
    view.target = view.eye + glm::dvec3(unit(random), unit(random), 0.3 * unit(random));
    view.orthographic = round % 3 == 0;
    view.orthographicHeight = 80.0;
    view.width = 16384;
    view.height = 9000;
    const View tile = tileOfPicture(view, 5000, 3000, 700, 500);
    EXPECT_EQ(wholePicture(tile), view);
    EXPECT_EQ(tileOfPicture(tile, -5000, -3000, 16384, 9000).tile.left, 0);
    const glm::dvec3 point = view.eye + 10.0 * (view.target - view.eye) + glm::dvec3(unit(random));
    const auto pixel = [&](const View& v) {
      const Projection p = projection(v);
      const glm::dvec4 d(point - p.eye, 1.0);
      return glm::dvec2(glm::dot(p.rowX, d), glm::dot(p.rowY, d)) / glm::dot(p.rowW, d);
    };
    EXPECT_LT(glm::distance(pixel(tile) + glm::dvec2(5000.0, 3000.0), pixel(view)), 1e-6);
    EXPECT_EQ(pixelsAt(tile, 1.0, 7.0), pixelsAt(view, 1.0, 7.0));
  }
}

TEST(PictureTiles, GetTheNodesOfTheWholeThatReachIntoThemWithAsManyPoints) {
  const test::Terrain terrain = test::makeTerrain({6, 16, 20}, false);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  int chosen = 0;
  for (int round = 0; round < 40; ++round) {
    View view = test::viewOfTerrain(terrain.info, unit(random), unit(random), 2.0 + 100.0 * unit(random));
    view.orthographic = round % 4 == 0;
    view.orthographicHeight = 200.0 * unit(random) + 1.0;
    SelectionOptions options;
    options.pointBudget = SelectionOptions::kMaxPointBudget;
    Selection whole, some;
    selectNodes(terrain.hierarchy, view, options, whole);
    const int left = static_cast<int>(random() % static_cast<unsigned>(view.width));
    const int top = static_cast<int>(random() % static_cast<unsigned>(view.height));
    const View tile =
        tileOfPicture(view, left, top, std::min(200, view.width - left), std::min(150, view.height - top));
    selectNodes(terrain.hierarchy, tile, options, some);
    // The order is the same too, so that among points at equal depth the same one is seen.
    const ViewVolume volume(tile);
    std::vector<SelectedNode> expected;
    for (const SelectedNode& node : whole.nodes)
      if (contourInView(contourOf(terrain.hierarchy.nodes[node.node]), 0.0, volume)) expected.push_back(node);
    ASSERT_EQ(some.nodes.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
      EXPECT_EQ(some.nodes[i].node, expected[i].node);
      EXPECT_EQ(some.nodes[i].pointCount, expected[i].pointCount);
      EXPECT_EQ(some.nodes[i].precision, expected[i].precision);
    }
    chosen += static_cast<int>(some.nodes.size());
  }
  EXPECT_GT(chosen, 200);
}

}  // namespace
}  // namespace strata
