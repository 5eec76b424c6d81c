#include "tests/support/fill_judge.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace strata::test {
namespace {

constexpr float kSameDepth = 0.02f;  ///< share of the depth

template <typename T>
void keep(std::vector<T>& values, const std::vector<std::uint32_t>& kept) {
  if (values.empty()) return;
  std::vector<T> left;
  for (const std::uint32_t i : kept) left.push_back(values[i]);
  values = std::move(left);
}

/// The nearest and the farthest depth of the 3 x 3 pixels around (x, y). The nearest is infinite where all are empty.
struct DepthRange {
  float nearest = std::numeric_limits<float>::infinity(), farthest = 0.0f;
};
DepthRange depthsAround(const Picture& picture, int x, int y) {
  DepthRange range;
  for (int v = std::max(y - 1, 0); v <= std::min(y + 1, picture.height - 1); ++v)
    for (int u = std::max(x - 1, 0); u <= std::min(x + 1, picture.width - 1); ++u) {
      const float depth = picture.depth[static_cast<std::size_t>(v * picture.width + u)];
      if (!std::isfinite(depth)) continue;
      range.nearest = std::min(range.nearest, depth);
      range.farthest = std::max(range.farthest, depth);
    }
  return range;
}

}  // namespace

RenderList thinned(const RenderList& list, double share, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::bernoulli_distribution stays(share);
  RenderList out;
  out.view = list.view;
  for (const RenderItem& item : list.items) {
    auto node = std::make_shared<NodeData>(*item.node);
    std::vector<std::uint32_t> kept;
    node->batches.clear();
    for (Batch batch : item.node->batches) {
      const std::uint32_t end = batch.firstPoint + batch.pointCount;
      const auto first = static_cast<std::uint32_t>(kept.size());
      for (std::uint32_t i = batch.firstPoint; i < end; ++i)
        if (stays(random)) kept.push_back(i);
      batch.firstPoint = first;
      batch.pointCount = static_cast<std::uint32_t>(kept.size()) - first;
      if (batch.pointCount > 0) node->batches.push_back(batch);
    }
    if (kept.empty()) continue;
    for (auto& plane : node->position) keep(plane, kept);
    keep(node->colour, kept);
    keep(node->intensity, kept);
    keep(node->classification, kept);
    keep(node->returnNumber, kept);
    keep(node->normal, kept);
    node->spacing *=
        static_cast<float>(std::sqrt(static_cast<double>(item.node->pointCount()) / static_cast<double>(kept.size())));
    out.items.push_back({node, node->pointCount()});
    out.pointCount += node->pointCount();
  }
  return out;
}

FillJudgement judgeFill(const Picture& full, const Picture& filled) {
  std::uint64_t pixels = 0, covered = 0, wrong = 0;
  for (int y = 0; y < full.height; ++y)
    for (int x = 0; x < full.width; ++x) {
      const auto i = static_cast<std::size_t>(y * full.width + x);
      const DepthRange range = depthsAround(full, x, y);
      const bool drawn = filled.pointId[i] != Picture::kNoPoint;
      if (drawn && filled.depth[i] < (1.0f - kSameDepth) * range.nearest) ++wrong;
      if (full.pointId[i] == Picture::kNoPoint) continue;
      ++pixels;
      if (drawn && filled.depth[i] <= (1.0f + kSameDepth) * range.farthest) ++covered;
    }
  FillJudgement judged;
  if (pixels > 0) judged.covered = static_cast<double>(covered) / static_cast<double>(pixels);
  if (!full.pointId.empty()) judged.wrong = static_cast<double>(wrong) / static_cast<double>(full.pointId.size());
  return judged;
}

double flicker(const FilledFrame& now, const FilledFrame& before) {
  const Picture& full = now.full;
  const ViewBasis basis = viewBasis(now.view);
  const double perPixel = 1.0 / pixelsAt(now.view, 1.0, 1.0);
  const Projection earlier = projection(before.view);
  double sum = 0.0, places = 0.0;
  for (int y = 0; y < full.height; ++y)
    for (int x = 0; x < full.width; ++x) {
      const auto i = static_cast<std::size_t>(y * full.width + x);
      if (full.pointId[i] == Picture::kNoPoint) continue;
      const double depth = static_cast<double>(full.depth[i]);
      const double side = (x + 0.5 - 0.5 * full.width) * perPixel, up = (0.5 * full.height - y - 0.5) * perPixel;
      const glm::dvec3 place = now.view.eye + depth * (basis.forward + side * basis.right + up * basis.up);
      const glm::dvec4 d(place - earlier.eye, 1.0);
      const double w = glm::dot(earlier.rowW, d);
      const double u = std::floor(glm::dot(earlier.rowX, d) / w), v = std::floor(glm::dot(earlier.rowY, d) / w);
      if (!(w > 0.0) || !(u >= 0.0 && v >= 0.0 && u < full.width && v < full.height)) continue;
      const auto j = static_cast<std::size_t>(v) * static_cast<std::size_t>(full.width) + static_cast<std::size_t>(u);
      if (!(static_cast<double>(before.full.depth[j]) > (1.0 - static_cast<double>(kSameDepth)) * w)) continue;
      for (int shift = 0; shift < 24; shift += 8)
        sum += std::abs(static_cast<int>(now.filled.colour[i] >> shift & 255u) -
                        static_cast<int>(before.filled.colour[j] >> shift & 255u));
      places += 3.0;
    }
  return places > 0.0 ? sum / places : 0.0;
}

}  // namespace strata::test
