// A clip for the selection: nodes that it leaves out would not have been seen.
#include <gtest/gtest.h>

#include <map>

#include "lod/hierarchy_index.h"
#include "lod/selection.h"
#include "lod/streamer.h"
#include "render/create_rasterizer.h"
#include "tests/support/lod_store.h"
#include "tests/support/make_node.h"
#include "tests/support/random.h"

namespace strata {
namespace {

using test::makeTerrain;
using test::Random;
using test::Terrain;
using test::TerrainOptions;

Box randomBox(const Box& within, Random& random) {
  Box box;
  for (int corner = 0; corner < 2; ++corner) {
    const glm::dvec3 share(random.in(-0.1, 1.1), random.in(-0.1, 1.1), random.in(-0.01, 0.01));
    box.add(within.min + share * within.size());
  }
  return box;
}

Clip randomClip(const Box& within, Random& random) {
  Clip clip;
  for (int i = static_cast<int>(random.in(0.0, 3.0)); i > 0; --i) clip.boxes.push_back(randomBox(within, random));
  for (int i = static_cast<int>(random.in(0.0, 3.0)); i > 0; --i) clip.cutouts.push_back(randomBox(within, random));
  if (random.in(0.0, 1.0) < 0.3) {
    const glm::dvec3 normal(random.in(-1.0, 1.0), random.in(-1.0, 1.0), random.in(-0.1, 0.1));
    const glm::dvec3 place = within.min + within.size() * glm::dvec3(random.in(0, 1), random.in(0, 1), 0.0);
    clip.planes.emplace_back(normal, -glm::dot(normal, place));
  }
  return clip;
}

TEST(SelectionClip, LeavesOutNothingThatIsSeenAtAnyPrecision) {
  const TerrainOptions shape{.levels = 5, .side = 24, .cubeBits = 18};
  const Terrain terrain = makeTerrain(shape, true);
  const auto store = test::makeStore(terrain);
  const HierarchyIndex index = indexHierarchy(terrain.hierarchy);
  const auto rasterizer = createRasterizer(Backend::cpu, {}, nullptr);
  std::map<std::uint32_t, std::shared_ptr<NodeData>> nodes[2];
  Random random(11);
  std::size_t left = 0, all = 0;
  for (int round = 0; round < 150; ++round) {
    const View view =
        test::viewOfTerrain(terrain.info, random.in(0.1, 0.9), random.in(0.0, 0.6), random.in(5.0, 150.0), 320, 240);
    DrawOptions draw;
    draw.clip = randomClip(terrain.info.rootCube(), random);
    Picture pictures[2];
    for (const bool clipped : {false, true}) {
      SelectionOptions options;
      options.pointBudget = SelectionOptions::kMaxPointBudget;
      if (clipped) options.shown.clip = draw.clip;
      Selection selection;
      selectNodes({terrain.hierarchy, index.reach}, view, options, selection);
      RenderList list;
      list.view = view;
      const std::size_t coarse = static_cast<std::size_t>(round % 2);
      for (const SelectedNode& selected : selection.nodes) {
        auto& node = nodes[coarse][selected.node];
        if (node == nullptr) {
          node = std::make_shared<NodeData>();
          readForDrawing(*store, selected.node, coarse != 0 ? Precision::low10 : Precision::full30, *node);
        }
        list.items.push_back({node, selected.pointCount});
        list.pointCount += selected.pointCount;
      }
      (clipped ? left : all) += selection.nodes.size();
      rasterizer->draw(list, view, draw, pictures[clipped ? 1 : 0]);
    }
    ASSERT_EQ(pictures[0].colour, pictures[1].colour) << "round " << round;
    ASSERT_EQ(pictures[0].depth, pictures[1].depth) << "round " << round;
  }
  EXPECT_LT(left, all * 3 / 4) << "or nothing was tried";
  EXPECT_GT(left, all / 20);
}

TEST(SelectionClip, SparesTheBudgetAndTheDiskWhatIsCutAway) {
  const Terrain terrain = makeTerrain({.levels = 5, .cubeBits = 18}, true);
  const View view = test::viewOfTerrain(terrain.info, 0.5, 0.3, 60.0);
  const Box cube = terrain.info.rootCube();
  StreamerOptions options;
  Box box{cube.min, cube.max};
  box.max.x = cube.centre().x;
  options.selection.shown.clip.boxes.push_back(box);
  Streamer half(test::makeStore(terrain), options);
  Streamer whole(test::makeStore(terrain), {});
  for (Streamer* streamer : {&half, &whole}) {
    streamer->setView(view);
    ASSERT_TRUE(streamer->waitUntilComplete(std::chrono::seconds{60}));
  }
  EXPECT_EQ(half.beginFrame().missingNodes, 0u);
  EXPECT_LT(half.stats().nodesLoaded, whole.stats().nodesLoaded * 3 / 4);
  EXPECT_LT(half.beginFrame().pointCount, whole.beginFrame().pointCount * 3 / 4);

  options.selection.shown.clip = {};
  half.setSelection(options.selection);
  ASSERT_TRUE(half.waitUntilComplete(std::chrono::seconds{60}));
  EXPECT_EQ(half.beginFrame().items.size(), whole.beginFrame().items.size()) << "comes back when the box goes";
}

}  // namespace
}  // namespace strata
