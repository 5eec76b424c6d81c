#include "tests/support/oracle.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/plan/batch_plan.h"

namespace strata::test {
namespace {

constexpr double kEdgePx = 1e-3;
constexpr double kDepthTie = 1e-6;

struct Projected {
  double column, row, depth;
};

Projected project(const Projection& p, const glm::dvec3& position) {
  const glm::dvec4 d(position - p.eye, 1.0);
  const double w = glm::dot(p.rowW, d);
  return {glm::dot(p.rowX, d) / w, glm::dot(p.rowY, d) / w, glm::dot(p.rowDepth, d)};
}

bool inImage(const Projected& point, const View& view) {
  return point.depth >= view.nearPlane && point.depth > 0.0 && point.column >= 0.0 && point.column < view.width &&
         point.row >= 0.0 && point.row < view.height;
}

bool isWanted(const DrawOptions& options, const NodeData& node, std::uint32_t point, const glm::dvec3& position) {
  if (!node.classification.empty() && !options.classes[node.classification[point]]) return false;
  bool inBoxes = options.clip.boxes.empty();
  for (const Box& box : options.clip.boxes) inBoxes = inBoxes || box.contains(position);
  for (const Box& box : options.clip.cutouts) inBoxes = inBoxes && !box.contains(position);
  for (const glm::dvec4& plane : options.clip.planes)
    if (glm::dot(plane, glm::dvec4(position, 1.0)) < 0.0) return false;
  return inBoxes;
}

/// Calls visit(id, projected) for every point of the list that `options` keep.
template <typename Visit>
void forEachPoint(const RenderList& list, const View& view, const DrawOptions& options, Visit visit) {
  const ViewConstants constants = viewConstants(view);
  std::uint32_t firstId = 0;
  for (const RenderItem& item : list.items) {
    const bool kept = gazeKeeps(constants, options.gaze, *item.node);
    for (const Batch& batch : item.node->batches) {
      if (!kept) break;
      const Precision precision = batchPrecision(constants, *item.node, batch);
      for (std::uint32_t i = 0; i < batch.pointCount && batch.firstPoint + i < item.pointCount; ++i) {
        const std::uint32_t point = batch.firstPoint + i;
        const glm::dvec3 position = pointPosition(*item.node, batch, point, precision);
        if (isWanted(options, *item.node, point, position))
          visit(firstId + point, project(constants.projection, position));
      }
    }
    firstId += item.pointCount;
  }
}

bool explained(const Projected& point, const View& view) {
  const auto nearEdge = [](double x) { return std::abs(x - std::round(x)) <= kEdgePx; };
  return nearEdge(point.column) || nearEdge(point.row) ||
         std::abs(point.depth - view.nearPlane) <= kDepthTie * view.nearPlane;
}

std::string describe(std::uint32_t id, const Projected& point) {
  return std::to_string(id) + " at (" + std::to_string(point.column) + ", " + std::to_string(point.row) + ") depth " +
         std::to_string(point.depth);
}

}  // namespace

Picture oraclePicture(const RenderList& list, const View& view, const DrawOptions& options) {
  Picture picture;
  picture.width = view.width;
  picture.height = view.height;
  const auto pixels = static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
  picture.depth.assign(pixels, std::numeric_limits<float>::infinity());
  picture.pointId.assign(pixels, Picture::kNoPoint);
  forEachPoint(list, view, options, [&](std::uint32_t id, const Projected& point) {
    if (!inImage(point, view)) return;
    const std::size_t at = static_cast<std::size_t>(point.row) * static_cast<std::size_t>(view.width) +
                           static_cast<std::size_t>(point.column);
    const float depth = static_cast<float>(point.depth);
    if (depth < picture.depth[at] || (depth == picture.depth[at] && id < picture.pointId[at])) {
      picture.depth[at] = depth;
      picture.pointId[at] = id;
    }
  });
  return picture;
}

Comparison compareToOracle(const RenderList& list, const View& view, const Picture& picture,
                           const DrawOptions& options) {
  const Picture expected = oraclePicture(list, view, options);
  std::vector<Projected> points(list.pointCount);
  forEachPoint(list, view, options, [&](std::uint32_t id, const Projected& point) { points[id] = point; });
  Comparison result;
  for (std::size_t i = 0; i < expected.pointId.size(); ++i) {
    const std::uint32_t wanted = expected.pointId[i], found = picture.pointId[i];
    if (wanted == Picture::kNoPoint && found == Picture::kNoPoint) continue;
    ++result.covered;
    if (wanted == found) continue;
    ++result.different;
    bool known = false;
    for (const std::uint32_t id : {wanted, found}) known |= id != Picture::kNoPoint && explained(points[id], view);
    if (wanted != Picture::kNoPoint && found != Picture::kNoPoint && !known) {
      const double a = points[wanted].depth, b = points[found].depth;
      known = std::abs(a - b) <= kDepthTie * std::max(a, b);
    }
    if (known) continue;
    if (result.unexplained++ > 0) continue;
    result.firstUnexplained = "pixel (" + std::to_string(i % static_cast<std::size_t>(view.width)) + ", " +
                              std::to_string(i / static_cast<std::size_t>(view.width)) + "): wanted ";
    result.firstUnexplained += wanted == Picture::kNoPoint ? "nothing" : describe(wanted, points[wanted]);
    result.firstUnexplained += ", found ";
    result.firstUnexplained += found == Picture::kNoPoint ? "nothing" : describe(found, points[found]);
  }
  return result;
}

}  // namespace strata::test
