#include "render/plan/batch_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace strata {
namespace {

constexpr double kSurePx = 0.05;  ///< pixels; float arithmetic moves a point by less

glm::dvec3 boxMinFromEye(const ViewConstants& constants, const NodeData& node, const Batch& batch) {
  return (node.origin - constants.view.eye) + batch.boxMin;
}

}  // namespace

double projectedSizePx(const ViewConstants& c, const NodeData& node, const Batch& batch) {
  const double longest = std::max({batch.boxSize.x, batch.boxSize.y, batch.boxSize.z});
  if (c.view.orthographic) return longest * c.pixelsPerMetre;
  const glm::dvec3 lo = boxMinFromEye(c, node, batch);
  // The corner of the box that is nearest along the view direction bounds how large any part of it may appear.
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

bool gazeKeeps(const ViewConstants& c, const Gaze& gaze, const NodeData& node) {
  if (!gaze.on || node.batches.empty()) return true;
  // The node counts as a sphere around its batches: its centre gives the distance from the gaze, its boxes the size.
  glm::dvec3 lo(std::numeric_limits<double>::infinity()), hi(-std::numeric_limits<double>::infinity());
  for (const Batch& batch : node.batches) {
    lo = glm::min(lo, boxMinFromEye(c, node, batch));
    hi = glm::max(hi, boxMinFromEye(c, node, batch) + batch.boxSize);
  }
  const glm::dvec4 centre(0.5 * (lo + hi), 1.0);
  const double radius = 0.5 * glm::distance(lo, hi);
  const double depth = glm::dot(c.projection.rowDepth, centre);
  if (depth - radius <= c.view.nearPlane) return true;
  const double w = glm::dot(c.projection.rowW, centre);
  const glm::dvec2 pixel(glm::dot(c.projection.rowX, centre) / w, glm::dot(c.projection.rowY, centre) / w);
  const View whole = wholePicture(c.view);
  const glm::dvec2 at =
      glm::dvec2(gaze.at) * glm::dvec2(whole.width, whole.height) - glm::dvec2(c.view.tile.left, c.view.tile.top);
  const double away = glm::distance(pixel, at) / std::max(whole.height, 1);
  const double centrePx = static_cast<double>(gaze.centrePx), peripheryPx = static_cast<double>(gaze.peripheryPx);
  // The threshold grows in three steps, at thirds of the picture's height (Schütz 2022, 3.6).
  const double least = away < 1.0 / 3.0 ? centrePx : away < 2.0 / 3.0 ? 0.5 * (centrePx + peripheryPx) : peripheryPx;
  const glm::dvec3 size = hi - lo;
  return std::max({size.x, size.y, size.z}) * c.pixelsPerMetre / (c.view.orthographic ? 1.0 : depth) >= least;
}

namespace {

enum class Side { outside, partly, inside };

/// The side on which a box lies of planes that point inwards; box and planes are relative to the eye.
template <typename Planes>
Side sideOf(const Planes& planes, const glm::dvec3& lo, const glm::dvec3& hi) {
  Side side = Side::inside;
  for (const glm::dvec4& plane : planes) {
    // Values of the plane at the box's outermost and innermost corners.
    double nearest = plane.w, farthest = plane.w;
    for (int axis = 0; axis < 3; ++axis) {
      nearest += std::min(plane[axis] * lo[axis], plane[axis] * hi[axis]);
      farthest += std::max(plane[axis] * lo[axis], plane[axis] * hi[axis]);
    }
    if (farthest < 0.0) return Side::outside;
    if (!(nearest >= 0.0)) side = Side::partly;
  }
  return side;
}

/// The clip region relative to the eye. Sides are ordered outside < partly < inside, so the union of boxes is a
/// maximum, and intersections are minima.
struct EyeClip {
  EyeClip(const Clip& clip, const glm::dvec3& eye) {
    for (const Box& box : clip.boxes) boxes.push_back({box.min - eye, box.max - eye});
    for (const Box& box : clip.cutouts) cutouts.push_back({box.min - eye, box.max - eye});
    for (const glm::dvec4& plane : clip.planes)
      planes.emplace_back(glm::dvec3(plane), glm::dot(plane, glm::dvec4(eye, 1.0)));
  }
  Side side(const glm::dvec3& lo, const glm::dvec3& hi) const {
    Side inBoxes = boxes.empty() ? Side::inside : Side::outside;
    for (const Box& box : boxes) inBoxes = std::max(inBoxes, sideOfBox(box, lo, hi));
    for (const Box& cutout : cutouts) {
      const Side side = sideOfBox(cutout, lo, hi);
      const Side left = side == Side::inside ? Side::outside : side == Side::partly ? Side::partly : Side::inside;
      inBoxes = std::min(inBoxes, left);
    }
    return std::min(inBoxes, sideOf(planes, lo, hi));
  }

  static Side sideOfBox(const Box& box, const glm::dvec3& lo, const glm::dvec3& hi) {
    if (box.contains(lo) && box.contains(hi)) return Side::inside;
    const bool apart = glm::any(glm::lessThan(hi, box.min)) || glm::any(glm::greaterThan(lo, box.max));
    return apart ? Side::outside : Side::partly;
  }

  std::vector<Box> boxes, cutouts;
  std::vector<glm::dvec4> planes;
};

/// The planes of the image and the near plane, moved inwards by as much as rounding may move a point.
std::array<glm::dvec4, 5> surePlanes(const ViewConstants& c) {
  const Projection& p = c.projection;
  const glm::dvec4 nearest(0.0, 0.0, 0.0, 1.0001 * c.view.nearPlane);
  return {p.rowX - p.rowW * kSurePx, p.rowW * (c.view.width - kSurePx) - p.rowX, p.rowY - p.rowW * kSurePx,
          p.rowW * (c.view.height - kSurePx) - p.rowY, p.rowDepth - nearest};
}

}  // namespace

void planBatches(const RenderList& list, const View& view, const DrawOptions& options, DrawPlan& plan) {
  plan.constants = viewConstants(view);
  plan.grids.clear();
  plan.batches.clear();
  plan.pointCount = 0;
  plan.batchesCulled = 0;
  std::fill(std::begin(plan.batchesAt), std::end(plan.batchesAt), 0u);
  if (!plan.constants.drawable) return;
  GridFinder finder(plan.constants, options.clip, plan.grids);
  const EyeClip clip(options.clip, view.eye);
  const std::array<glm::dvec4, 5> sure = surePlanes(plan.constants);
  std::uint32_t firstId = 0;
  for (std::size_t i = 0; i < list.items.size(); firstId += list.items[i++].pointCount) {
    const NodeData* node = list.items[i].node.get();
    if (node == nullptr) continue;
    const std::uint32_t prefix = std::min(list.items[i].pointCount, node->pointCount());
    const bool kept = gazeKeeps(plan.constants, options.gaze, *node);
    for (const Batch& batch : node->batches) {
      if (batch.firstPoint >= prefix) break;
      PlannedBatch planned;
      planned.pointCount = std::min(batch.pointCount, prefix - batch.firstPoint);
      if (planned.pointCount == 0) continue;
      const glm::dvec3 lo = boxMinFromEye(plan.constants, *node, batch), hi = lo + batch.boxSize;
      planned.precision = batchPrecision(plan.constants, *node, batch);
      const Side clipSide = clip.side(lo, hi);
      std::optional<GridMapping> mapping;
      if (kept && clipSide != Side::outside && boxInFrustum(plan.constants.planes, lo, hi))
        mapping = finder.map(*node, batch, planned.precision);
      if (!mapping) {
        ++plan.batchesCulled;
        continue;
      }
      planned.mapping = *mapping;
      planned.clipped = clipSide == Side::partly;
      planned.inside = sideOf(sure, lo, hi) == Side::inside;
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
