// Occlusion culling may leave out nothing that is seen. The tests compare with the oracle's picture of all points,
// where surfaces count as closed only when they leave no pixel open, and with the scene that the scan was made of,
// where they count as closed by the scan's own spacing.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <vector>

#include "converter/convert.h"
#include "io/store/node_codec.h"
#include "io/synthetic/scanner.h"
#include "io/synthetic/scenes.h"
#include "lod/coarse_depth.h"
#include "lod/selection.h"
#include "lod/streamed_node.h"
#include "tests/support/oracle.h"
#include "tests/support/random.h"
#include "tests/support/test_data.h"

namespace strata {
namespace {

using test::Random;

constexpr std::uint64_t kPoints = 1'500'000;

/// A converted scan, all of it in memory.
struct Scan {
  std::unique_ptr<Store> store;
  std::unique_ptr<synthetic::ScannerScan> truth;
  std::vector<std::shared_ptr<StreamedNode>> nodes;
  glm::dvec2 eyeHeights{0.0};

  explicit Scan(const std::string& name)
      : truth(name == "room" ? synthetic::makeRoom(kPoints, 1) : synthetic::makeCity(kPoints, 1)) {
    const test::TempFolder folder;
    ConvertOptions options;
    options.inputs = {"synthetic:" + name + "?points=" + std::to_string(kPoints) + "&seed=1"};
    options.output = (folder.path() / "scan.strata").string();
    options.threads = 2;
    options.nodePoints = 4096;
    options.memoryBytes = kLeastMemoryBytes;
    convert(options, ConvertControl{});
    store = std::make_unique<Store>(options.output);
    for (std::uint32_t i = 0; i < store->hierarchy().nodes.size(); ++i) {
      auto node = std::make_shared<StreamedNode>();
      readForDrawing(*store, i, Precision::full30, *node);
      const NodeRecord& record = store->hierarchy().nodes[i];
      findOccluders(*node, nodeCube({record.key}, store->info().rootCube()), record.childMask, node->occluding);
      nodes.push_back(std::move(node));
    }
    eyeHeights = name == "room" ? glm::dvec2(1.2, 1.9) : glm::dvec2(1.5, 25.0);
  }
};

const Scan& scanOf(const std::string& name) {
  static const Scan room("room"), city("city");
  return name == "room" ? room : city;
}

/// A view from a free place, in any direction that people look.
View randomView(const Scan& scan, Random& random) {
  const Box bounds = scan.store->info().bounds;
  const glm::dvec3 origin = scan.truth->extent().origin;
  View view;
  do {
    view.eye = bounds.min + bounds.size() * glm::dvec3(random.in(0.15, 0.85), random.in(0.15, 0.85), 0.0);
    view.eye.z = origin.z + random.in(scan.eyeHeights.x, scan.eyeHeights.y);
  } while (!scan.truth->scene().isFree(glm::vec3(view.eye - origin), 0.3f));
  const double around = random.in(0.0, 6.2831853);
  view.target = view.eye + glm::dvec3(std::cos(around), std::sin(around), random.in(-0.6, 0.4));
  view.fovY = random.in(0.6, 1.4);
  view.nearPlane = 0.05;
  view.orthographic = random.in(0.0, 1.0) < 0.1;
  view.orthographicHeight = random.in(2.0, 20.0);
  return view;
}

CoarseDepth depthOf(const Scan& scan, const View& view, const OcclusionOptions& options,
                    std::span<const SelectedNode> resident) {
  CoarseDepth depth;
  depth.clear(view, options);
  for (const SelectedNode& node : resident) depth.add(scan.nodes[node.node]->occluding);
  depth.finish();
  return depth;
}

Selection select(const Scan& scan, const View& view, const CoarseDepth* depth, double pointsPerPixel) {
  SelectionOptions options;
  options.pointsPerPixel = pointsPerPixel;
  options.pointBudget = SelectionOptions::kMaxPointBudget;
  options.minimumPixels = 0.0;
  Selection selection;
  selectNodes(scan.store->hierarchy(), view, depth, options, selection);
  return selection;
}

/// By node: selected without occlusion, but not with it.
std::vector<bool> culledNodes(const Scan& scan, const Selection& without, const Selection& with) {
  std::vector<bool> culled(scan.nodes.size(), false);
  for (const SelectedNode& node : without.nodes) culled[node.node] = true;
  for (const SelectedNode& node : with.nodes) culled[node.node] = false;
  return culled;
}

constexpr double kEverything = 1e12;  // points a pixel

class Occlusion : public testing::TestWithParam<const char*> {};

TEST_P(Occlusion, NoPixelOfTheFullPictureBelongsToANodeThatWasCulled) {
  const Scan& scan = scanOf(GetParam());
  RenderList all;
  for (const auto& node : scan.nodes) all.items.push_back({node, node->pointCount()});
  Random random(7);
  std::uint64_t covered = 0, lost = 0, culledInAll = 0;
  for (int i = 0; i < 100; ++i) {
    View view = randomView(scan, random);
    view.width = static_cast<int>(random.in(40.0, 160.0));
    view.height = static_cast<int>(random.in(30.0, 120.0));
    const Selection without = select(scan, view, nullptr, kEverything);
    OcclusionOptions options = OcclusionOptions::exact();
    options.mostOccluders = 1u << 30;
    const CoarseDepth depth = depthOf(scan, view, options, without.nodes);
    const Selection with = select(scan, view, &depth, kEverything);
    const std::vector<bool> culled = culledNodes(scan, without, with);
    culledInAll += without.nodes.size() - with.nodes.size();

    const Picture picture = test::oraclePicture(all, view);
    std::vector<std::uint64_t> firstId;
    std::uint64_t points = 0;
    for (const RenderItem& item : all.items) {
      firstId.push_back(points);
      points += item.pointCount;
    }
    for (const std::uint32_t id : picture.pointId) {
      if (id == Picture::kNoPoint) continue;
      const auto after = std::upper_bound(firstId.begin(), firstId.end(), std::uint64_t{id});
      ++covered;
      lost += culled[static_cast<std::size_t>(after - firstId.begin()) - 1] ? 1 : 0;
    }
  }
  RecordProperty("culled", static_cast<int>(culledInAll));
  RecordProperty("lost_pixels", static_cast<int>(lost));
  EXPECT_GT(culledInAll, 300u) << "or this says nothing";
  // A square of a surface that holds one point may leave a corner of a pixel open when neither grid fits the other.
  EXPECT_LE(static_cast<double>(lost), 1e-4 * static_cast<double>(covered)) << lost << " of " << covered;
}

/// True when a point is in the picture and nothing of the scene hides it.
bool isSeen(const Scan& scan, const View& view, const Projection& p, const glm::dvec3& point) {
  const glm::dvec4 d(point - p.eye, 1.0);
  const double w = glm::dot(p.rowW, d);
  if (glm::dot(p.rowDepth, d) < view.nearPlane) return false;
  const double x = glm::dot(p.rowX, d) / w, y = glm::dot(p.rowY, d) / w;
  if (!(x >= 0.0 && x < view.width && y >= 0.0 && y < view.height)) return false;
  const auto distance = static_cast<float>(glm::length(glm::dvec3(d)));
  glm::vec3 direction = glm::vec3(glm::dvec3(d)) / distance;
  for (glm::length_t axis = 0; axis < 3; ++axis)
    if (direction[axis] == 0.0f) direction[axis] = 1e-7f;
  constexpr float kOwnSurface = 0.05f;  // noise and rounding: what stops the ray there is the point itself
  synthetic::Hit hit;
  const synthetic::Ray ray(glm::vec3(view.eye - scan.truth->extent().origin), direction, 1);
  return !scan.truth->scene().trace(ray, distance, hit) || hit.t > distance - kOwnSurface;
}

TEST_P(Occlusion, CullsNothingThatTheSceneLeavesOpenToTheEye) {
  const Scan& scan = scanOf(GetParam());
  Random random(8);
  std::uint64_t seen = 0, lost = 0, culledInAll = 0, selectedInAll = 0;
  for (int i = 0; i < 60; ++i) {
    View view = randomView(scan, random);
    view.orthographic = false;
    const double pointsPerPixel = i % 2 == 0 ? 1.0 : 0.25;
    const Selection resident = select(scan, view, nullptr, pointsPerPixel);
    const CoarseDepth depth = depthOf(scan, view, {}, resident.nodes);
    const Selection with = select(scan, view, &depth, pointsPerPixel);
    const std::vector<bool> culled = culledNodes(scan, resident, with);
    selectedInAll += resident.nodes.size();
    culledInAll += resident.nodes.size() - with.nodes.size();
    const Projection p = projection(view);
    for (const SelectedNode& selected : resident.nodes) {
      const StreamedNode& node = *scan.nodes[selected.node];
      for (const Batch& batch : node.batches)
        for (std::uint32_t at = 0; at < batch.pointCount; at += 16) {
          if (!isSeen(scan, view, p, pointPosition(node, batch, batch.firstPoint + at, Precision::full30))) continue;
          ++seen;
          lost += culled[selected.node] ? 1 : 0;
        }
    }
  }
  RecordProperty("culled_percent", static_cast<int>(100 * culledInAll / selectedInAll));
  RecordProperty("lost_points", static_cast<int>(lost));
  EXPECT_GT(culledInAll * (GetParam() == std::string("room") ? 6 : 20), selectedInAll) << culledInAll;
  EXPECT_LE(static_cast<double>(lost), 1e-4 * static_cast<double>(seen)) << lost << " of " << seen;
}

INSTANTIATE_TEST_SUITE_P(Scans, Occlusion, testing::Values("room", "city"));

}  // namespace
}  // namespace strata
