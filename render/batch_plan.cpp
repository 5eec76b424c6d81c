#include "render/batch_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace strata {
namespace {

constexpr double kPixelsAt10Bits = 500.0;
constexpr double kPixelsAt20Bits = 500.0 * 1024.0;
constexpr double kLargestFloat = 1e30;  ///< beyond it products of floats may overflow

bool finite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

bool usable(const glm::vec4& row) {
  for (int i = 0; i < 4; ++i)
    if (!(std::abs(static_cast<double>(row[i])) < kLargestFloat)) return false;
  return true;
}

glm::dvec3 boxMinFromEye(const ViewConstants& constants, const NodeData& node, const Batch& batch) {
  return (node.origin - constants.view.eye) + batch.boxMin;
}

}  // namespace

ViewConstants viewConstants(const View& view) {
  ViewConstants c;
  c.view = view;
  c.projection = projection(view);
  c.planes = frustumPlanes(view);
  c.rowX = c.projection.rowX - c.projection.rowW * (0.5 * view.width);
  c.rowY = c.projection.rowY - c.projection.rowW * (0.5 * view.height);
  c.pixelsPerMetre = glm::length(glm::dvec3(c.rowY));
  if (!view.orthographic && c.pixelsPerMetre > 0.0) {
    const double halfDiagonal = 0.5 * std::hypot(view.width, view.height);
    c.cornerStretch = std::hypot(1.0, halfDiagonal / c.pixelsPerMetre);
  }
  c.drawable = view.width > 0 && view.height > 0 && finite(view.eye) && finite(c.rowX) && finite(c.rowY) &&
               finite(c.projection.rowDepth) && std::isfinite(view.nearPlane);
  return c;
}

Viewport viewport(const ViewConstants& c) {
  Viewport v;
  v.width = static_cast<float>(c.view.width);
  v.height = static_cast<float>(c.view.height);
  v.halfWidth = 0.5f * v.width;
  v.halfHeight = 0.5f * v.height;
  v.nearDepth = std::max(static_cast<float>(c.view.nearPlane), std::numeric_limits<float>::min());
  v.perspective = !c.view.orthographic;
  return v;
}

double projectedSizePx(const ViewConstants& c, const NodeData& node, const Batch& batch) {
  const double longest = std::max({batch.boxSize.x, batch.boxSize.y, batch.boxSize.z});
  if (c.view.orthographic) return longest * c.pixelsPerMetre;
  const glm::dvec3 lo = boxMinFromEye(c, node, batch);
  double nearest = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double forward = c.projection.rowDepth[axis];
    nearest += forward * (forward >= 0.0 ? lo[axis] : lo[axis] + batch.boxSize[axis]);
  }
  return longest * c.pixelsPerMetre * c.cornerStretch / std::max({nearest, c.view.nearPlane, 1e-9});
}

Precision batchPrecision(const ViewConstants& c, const NodeData& node, const Batch& batch) {
  const double size = projectedSizePx(c, node, batch);
  const int wanted = size < kPixelsAt10Bits ? 1 : size < kPixelsAt20Bits ? 2 : 3;
  const int bits = std::max({int{batch.bits.x}, int{batch.bits.y}, int{batch.bits.z}});
  const int filled = bits <= 10 ? 1 : bits <= 20 ? 2 : 3;
  return static_cast<Precision>(std::min({wanted, filled, node.loadedPlanes()}));
}

BatchTransform batchTransform(const ViewConstants& c, const NodeData& node, const Batch& batch, Precision precision) {
  const int bits = 10 * static_cast<int>(precision);
  const double cells = static_cast<double>(1u << bits);
  const glm::dvec3 lo = boxMinFromEye(c, node, batch);
  BatchTransform t;
  glm::dvec3 cell, rest;
  for (int axis = 0; axis < 3; ++axis) {
    cell[axis] = batch.boxSize[axis] / cells;
    const double half = batch.bits[axis] > bits ? 0.5 : 0.0;
    const double first = lo[axis] + half * cell[axis];  // of X = 0
    double eyeCell = cell[axis] > 0.0 ? std::round(-first / cell[axis]) : 0.0;
    eyeCell = std::clamp(eyeCell, -cells, 2.0 * cells);  // X - E then fits 32 bits
    t.eyeCell[axis] = static_cast<int>(static_cast<std::uint32_t>(static_cast<std::int64_t>(eyeCell)));
    rest[axis] = first + eyeCell * cell[axis];
  }
  const auto fold = [&](const glm::dvec4& row) {
    const glm::dvec3 direction(row);
    return glm::vec4(glm::dvec4(direction * cell, glm::dot(direction, rest) + row.w));
  };
  t.x = fold(c.rowX);
  t.y = fold(c.rowY);
  t.depth = fold(c.projection.rowDepth);
  return t;
}

void planBatches(const RenderList& list, const View& view, DrawPlan& plan) {
  plan.constants = viewConstants(view);
  plan.batches.clear();
  plan.pointCount = 0;
  plan.batchesCulled = 0;
  std::fill(std::begin(plan.batchesAt), std::end(plan.batchesAt), 0u);
  if (!plan.constants.drawable) return;
  std::uint32_t firstId = 0;
  for (std::size_t i = 0; i < list.items.size(); firstId += list.items[i++].pointCount) {
    const NodeData* node = list.items[i].node.get();
    if (node == nullptr) continue;
    const std::uint32_t prefix = std::min(list.items[i].pointCount, node->pointCount());
    for (const Batch& batch : node->batches) {
      if (batch.firstPoint >= prefix) break;
      PlannedBatch planned;
      planned.pointCount = std::min(batch.pointCount, prefix - batch.firstPoint);
      if (planned.pointCount == 0) continue;
      const glm::dvec3 lo = boxMinFromEye(plan.constants, *node, batch);
      planned.precision = batchPrecision(plan.constants, *node, batch);
      planned.transform = batchTransform(plan.constants, *node, batch, planned.precision);
      const BatchTransform& t = planned.transform;
      if (!boxInFrustum(plan.constants.planes, lo, lo + batch.boxSize) || !usable(t.x) || !usable(t.y) ||
          !usable(t.depth)) {
        ++plan.batchesCulled;
        continue;
      }
      planned.node = node;
      planned.item = static_cast<std::uint32_t>(i);
      planned.firstPoint = batch.firstPoint;
      planned.firstId = firstId + batch.firstPoint;
      ++plan.batchesAt[static_cast<int>(planned.precision) - 1];
      plan.pointCount += planned.pointCount;
      plan.batches.push_back(planned);
    }
  }
}

DrawStats planStats(const DrawPlan& plan) {
  DrawStats stats;
  stats.pointsDrawn = plan.pointCount;
  stats.batchesDrawn = static_cast<std::uint32_t>(plan.batches.size());
  stats.batchesCulled = plan.batchesCulled;
  std::copy(std::begin(plan.batchesAt), std::end(plan.batchesAt), std::begin(stats.batchesAt));
  return stats;
}

}  // namespace strata
