// Properties of the selection that hold for every view, tested with random views.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <set>

#include "lod/contour.h"
#include "lod/hierarchy_index.h"
#include "lod/selection.h"
#include "tests/support/lod_store.h"
#include "tests/support/random.h"

namespace strata {
namespace {

using test::makeTerrain;
using test::Random;
using test::Terrain;

View randomView(Random& random, const Box& around) {
  View view;
  view.eye = around.min + around.size() * glm::dvec3(random.in(-0.3, 1.3), random.in(-0.3, 1.3), random.in(-0.1, 0.3));
  view.target = view.eye + random.direction();
  view.fovY = random.in(0.2, 2.0);
  view.width = static_cast<int>(random.in(100, 2000));
  view.height = static_cast<int>(random.in(100, 2000));
  view.nearPlane = random.in(0.001, 1.0);
  view.orthographic = random.in(0, 1) < 0.2;
  view.orthographicHeight = random.in(1.0, 500.0);
  return view;
}

NodeRecord randomBox(Random& random) {
  NodeRecord record{};
  record.pointCount = 1000;
  record.spacing = 0.1f;
  const glm::dvec3 a = random.direction();
  const glm::dvec3 b = glm::normalize(glm::cross(a, random.direction()));
  const glm::dvec3 axes[3] = {a, b, glm::cross(a, b)};
  for (int i = 0; i < 3; ++i) {
    record.centre[i] = random.in(-20, 20);
    const double half = random.in(0, 1) < 0.2 ? 0.0 : std::exp(random.in(-4, 3));
    for (int k = 0; k < 3; ++k) record.halfAxis[i][k] = static_cast<float>(axes[i][k] * half);
  }
  return record;
}

bool inImage(const View& view, const glm::dvec3& point) {
  const Projection p = projection(view);
  const glm::dvec4 d(point - p.eye, 1.0);
  const double w = glm::dot(p.rowW, d);
  if (glm::dot(p.rowDepth, d) < view.nearPlane || w <= 0.0) return false;
  const double x = glm::dot(p.rowX, d) / w;
  const double y = glm::dot(p.rowY, d) / w;
  return x >= 0.0 && x < view.width && y >= 0.0 && y < view.height;
}

TEST(ContourInView, NeverCullsABoxWithAPointInTheImage) {
  Random random(1);
  int visible = 0;
  for (int round = 0; round < 4000; ++round) {
    const NodeRecord record = randomBox(random);
    const View view = randomView(random, Box{glm::dvec3(-25), glm::dvec3(25)});
    const Contour contour = contourOf(record);
    const bool kept = contourInView(contour, 0.0, ViewVolume(view));
    bool seen = false;
    for (int sample = 0; sample < 60 && !seen; ++sample) {
      glm::dvec3 point = contour.centre;
      for (std::size_t a = 0; a < 3; ++a) {
        const double at = sample < 8 ? ((sample >> a & 1) != 0 ? 1.0 : -1.0) : random.in(-1.0, 1.0);
        point += contour.axis[a] * (contour.half[a] * at);
      }
      seen = inImage(view, point);
    }
    visible += seen;
    EXPECT_TRUE(kept || !seen) << "round " << round;
  }
  EXPECT_GT(visible, 400) << "too few boxes were visible for the test to mean anything";
}

TEST(ContourInView, CullsABoxWhoseCornersAreAllBehindOnePlane) {
  Random random(2);
  int outside = 0;
  for (int round = 0; round < 4000; ++round) {
    const Contour contour = contourOf(randomBox(random));
    const View view = randomView(random, Box{glm::dvec3(-25), glm::dvec3(25)});
    bool behind = false;
    for (const glm::dvec4& plane : frustumPlanes(view)) {
      double most = -1e300;
      for (int corner = 0; corner < 8; ++corner) {
        glm::dvec3 point = contour.centre - view.eye;
        for (std::size_t a = 0; a < 3; ++a)
          point += contour.axis[a] * ((corner >> a & 1) != 0 ? contour.half[a] : -contour.half[a]);
        most = std::max(most, glm::dot(glm::dvec3(plane), point) + plane.w);
      }
      behind = behind || most < -1e-6;
    }
    outside += behind;
    EXPECT_FALSE(behind && contourInView(contour, 0.0, ViewVolume(view))) << "round " << round;
  }
  EXPECT_GT(outside, 400);
}

TEST(ProjectContour, NeverTakesAVisiblePointForFartherThanItIs) {
  Random random(3);
  for (int round = 0; round < 4000; ++round) {
    const Contour contour = contourOf(randomBox(random));
    const View view = randomView(random, Box{glm::dvec3(-25), glm::dvec3(25)});
    const ContourOnScreen screen = projectContour(contour, 0.0, ViewVolume(view));
    for (int sample = 0; sample < 40; ++sample) {
      glm::dvec3 point = contour.centre;
      for (std::size_t a = 0; a < 3; ++a) point += contour.axis[a] * (contour.half[a] * random.in(-1.0, 1.0));
      if (!inImage(view, point)) continue;
      const double depth = glm::dot(point - view.eye, viewBasis(view).forward);
      EXPECT_LE(pixelsAt(view, 1.0, depth), screen.pixelsPerMetre * (1 + 1e-9)) << "round " << round;
    }
  }
}

TEST(HierarchyIndex, ReachIsEnoughForEveryCornerOfEveryDescendant) {
  Random random(4);
  for (int round = 0; round < 50; ++round) {
    Hierarchy hierarchy;  // a chain with some branches
    for (std::uint32_t i = 0; i < 40; ++i) hierarchy.nodes.push_back(randomBox(random));
    for (std::uint32_t i = 0, next = 1; next < 40; ++i) {
      const auto children = std::min(1 + static_cast<std::uint32_t>(random.in(0, 2.99)), 40 - next);
      hierarchy.nodes[i].firstChild = next;
      hierarchy.nodes[i].childMask = static_cast<std::uint8_t>((1u << children) - 1);
      next += children;
    }
    const HierarchyIndex index = indexHierarchy(hierarchy);
    for (std::uint32_t node = 0; node < 40; ++node) {
      const Contour inner = contourOf(hierarchy.nodes[node]);
      for (std::uint32_t above = index.parent[node]; above < 40; above = index.parent[above])
        for (int corner = 0; corner < 8; ++corner) {
          glm::dvec3 point = inner.centre;
          for (std::size_t a = 0; a < 3; ++a)
            point += inner.axis[a] * ((corner >> a & 1) != 0 ? inner.half[a] : -inner.half[a]);
          EXPECT_LE(distanceTo(contourOf(hierarchy.nodes[above]), point), index.reach[above] + 1e-9);
        }
    }
  }
}

TEST(SelectionProperty, HoldsForRandomViews) {
  const Terrain terrain = makeTerrain({.levels = 6}, false);
  const Hierarchy& hierarchy = terrain.hierarchy;
  const std::vector<std::uint32_t> parents = test::parentsOf(hierarchy);
  Random random(5);
  Selection selection, again;
  std::size_t most = 0;
  for (int round = 0; round < 600; ++round) {
    const View view = randomView(random, terrain.info.rootCube());
    SelectionOptions options;
    options.pointsPerPixel = std::exp(random.in(-3, 2));
    options.pointBudget = static_cast<std::uint64_t>(std::exp(random.in(3, 16)));
    selectNodes(hierarchy, view, options, selection);

    std::set<std::uint32_t> seen;
    std::uint64_t points = 0;
    float priority = std::numeric_limits<float>::infinity();
    const ViewVolume volume(view);
    for (const SelectedNode& selected : selection.nodes) {
      ASSERT_LT(selected.node, hierarchy.nodes.size());
      EXPECT_TRUE(selected.node == 0 || seen.contains(parents[selected.node])) << "closed under parents, in order";
      EXPECT_TRUE(seen.insert(selected.node).second);
      EXPECT_GE(selected.pointCount, 1u);
      EXPECT_LE(selected.pointCount, hierarchy.nodes[selected.node].pointCount);
      EXPECT_TRUE(contourInView(contourOf(hierarchy.nodes[selected.node]), 0.0, volume));
      EXPECT_LE(selected.priority, priority) << "most urgent first";
      EXPECT_GE(selected.priority, 1.0f);
      priority = selected.priority;
      points += selected.pointCount;
    }
    EXPECT_EQ(points, selection.pointCount);
    EXPECT_LE(points, options.pointBudget);
    most = std::max(most, selection.nodes.size());

    selectNodes(hierarchy, view, options, again);
    ASSERT_EQ(again.nodes.size(), selection.nodes.size());
    for (std::size_t i = 0; i < again.nodes.size(); ++i) {
      EXPECT_EQ(again.nodes[i].node, selection.nodes[i].node);
      EXPECT_EQ(again.nodes[i].pointCount, selection.nodes[i].pointCount);
    }
  }
  EXPECT_GT(most, 200u);
}

/// How many points of the selection fall into the picture: for each node, its points times the share of its ground that
/// is in view.
double pointsInImage(const Terrain& terrain, const Selection& selection, const View& view) {
  constexpr int kSamples = 12;  // an axis
  double total = 0.0;
  for (const SelectedNode& selected : selection.nodes) {
    const Contour contour = contourOf(terrain.hierarchy.nodes[selected.node]);
    int inside = 0;
    for (int y = 0; y < kSamples; ++y)
      for (int x = 0; x < kSamples; ++x)
        inside +=
            inImage(view, contour.centre + contour.axis[0] * (contour.half[0] * ((2 * x + 1.0) / kSamples - 1.0)) +
                              contour.axis[1] * (contour.half[1] * ((2 * y + 1.0) / kSamples - 1.0)));
    total += selected.pointCount * (static_cast<double>(inside) / (kSamples * kSamples));
  }
  return total;
}

TEST(SelectionProperty, ASmoothPathChangesTheCountSmoothly) {
  // A node that enters at the border of the image brings points that are still outside of it; they do not count here.
  const Terrain terrain = makeTerrain({.levels = 6, .side = 32}, false);
  Random random(6);
  Selection selection;
  for (int walk = 0; walk < 4; ++walk) {
    const double x = random.in(0.3, 0.7);
    const double y = random.in(0.0, 0.3);
    const double startHeight = random.in(200.0, 500.0);
    double before = 0.0;
    for (int step = 0; step < 100; ++step) {
      const double height = startHeight * std::pow(0.995, step);
      const View view = test::viewOfTerrain(terrain.info, x, y, height);
      selectNodes(terrain.hierarchy, view, {}, selection);
      const double now = pointsInImage(terrain, selection, view);
      EXPECT_NEAR(now, step > 0 ? before : now, 0.03 * before) << "walk " << walk << " step " << step;
      before = now;
    }
    EXPECT_GT(before, 10'000.0);
  }
}

TEST(SelectionProperty, ANodeWhollyInViewGrowsWithoutJumps) {
  // One wall and four children, all in view from far off to near: each step may add what the distance says, no more.
  const Terrain terrain = makeTerrain({.levels = 2, .side = 64, .cubeBits = 14}, false);
  const Box cube = terrain.info.rootCube();
  std::uint64_t before = 0;
  Selection selection;
  for (double height = 400.0; height > 15.0; height *= 0.999) {
    View view;
    view.eye = cube.centre() + glm::dvec3(0.0, 0.0, height);
    view.target = cube.centre();
    view.up = {0, 1, 0};
    selectNodes(terrain.hierarchy, view, {}, selection);
    EXPECT_GE(selection.pointCount + 1, before);
    EXPECT_LE(static_cast<double>(selection.pointCount),
              1.006 * static_cast<double>(before) + 6.0 + (before == 0) * 1e9);
    before = selection.pointCount;
  }
  EXPECT_GT(before, 5 * 64u * 64u / 2);
}

TEST(SelectionProperty, EveryPixelOfACoveredGroundGetsTheDensityAskedFor) {
  // Oracle: points a square metre that the selection puts at a place, against points a pixel there.
  const Terrain terrain = makeTerrain({.levels = 7, .side = 32}, false);
  const Box cube = terrain.info.rootCube();
  Random random(7);
  Selection selection;
  int checked = 0;
  for (int round = 0; round < 40; ++round) {
    const View view =
        test::viewOfTerrain(terrain.info, random.in(0.2, 0.8), random.in(0.0, 0.5), random.in(60.0, 300.0));
    selectNodes(terrain.hierarchy, view, {}, selection);
    for (int sample = 0; sample < 200; ++sample) {
      const glm::dvec3 place(cube.min.x + random.in(0, 1) * cube.size().x, cube.min.y + random.in(0, 1) * cube.size().y,
                             cube.min.z + 0.03);
      if (!inImage(view, place)) continue;
      double density = 0.0;
      for (const SelectedNode& selected : selection.nodes) {
        const Box box = nodeCube(NodeKey{terrain.hierarchy.nodes[selected.node].key}, cube);
        if (place.x >= box.min.x && place.x < box.max.x && place.y >= box.min.y && place.y < box.max.y)
          density += selected.pointCount / (box.size().x * box.size().y);
      }
      const glm::dvec3 toPlace = place - view.eye;
      const double scale = pixelsAt(view, 1.0, glm::dot(toPlace, viewBasis(view).forward));
      const double wanted = scale * scale * std::abs(glm::normalize(toPlace).z);
      double whole = 0.0;  // the finest that the store has
      for (int level = 0; level < 7; ++level) whole += std::pow(32.0 * (1 << level) / cube.size().x, 2.0);
      EXPECT_GE(density, 0.95 * std::min(wanted, whole));
      ++checked;
    }
  }
  EXPECT_GT(checked, 500);
}

}  // namespace
}  // namespace strata
