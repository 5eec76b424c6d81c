#include "viewer/bench/screen_spacing.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "lod/contour.h"
#include "lod/selection.h"

namespace strata {
namespace {

/// A drawn node.
struct Drawn {
  std::uint32_t node;  ///< index of its record
  std::uint32_t points;
  double density = 0.0;  ///< points per square metre, those of its ancestors included
};

/// True when something nearer covers all of a few pixels spread over the rectangle that the contour has on the screen.
bool hiddenIn(const Picture& picture, const View& view, const Contour& contour, double reach) {
  constexpr int kSamples = 5;       // per side
  constexpr double kNearer = 0.99;  // of the contour's depth; points of the same surface do not hide it
  const Projection p = projection(view);
  double low[2] = {1e300, 1e300}, high[2] = {-1e300, -1e300}, nearest = 1e300;
  for (int corner = 0; corner < 8; ++corner) {
    glm::dvec3 at = contour.centre - p.eye;
    for (int axis = 0; axis < 3; ++axis)
      at += contour.axis[static_cast<std::size_t>(axis)] *
            ((corner >> axis & 1 ? 1.0 : -1.0) * (contour.half[static_cast<std::size_t>(axis)] + reach));
    const glm::dvec4 d(at, 1.0);
    const double w = glm::dot(p.rowW, d);
    nearest = std::min(nearest, glm::dot(p.rowDepth, d));
    if (!(w > 0.0) || nearest <= view.nearPlane) return false;
    const double pixel[2] = {glm::dot(p.rowX, d) / w, glm::dot(p.rowY, d) / w};
    for (int axis = 0; axis < 2; ++axis) {
      low[axis] = std::min(low[axis], pixel[axis]);
      high[axis] = std::max(high[axis], pixel[axis]);
    }
  }
  const auto sample = [&](int axis, int step, int size) {
    const double from = std::clamp(low[axis], 0.0, size - 1.0), to = std::clamp(high[axis], 0.0, size - 1.0);
    return static_cast<std::size_t>(from + (to - from) * (step + 0.5) / kSamples);
  };
  for (int y = 0; y < kSamples; ++y)
    for (int x = 0; x < kSamples; ++x)
      if (static_cast<double>(picture.depth[sample(1, y, picture.height) * static_cast<std::size_t>(picture.width) +
                                            sample(0, x, picture.width)]) > kNearer * nearest)
        return false;
  return true;
}

}  // namespace

double widestSpacing(const Hierarchy& hierarchy, const HierarchyIndex& index, const RenderList& list, const View& view,
                     const Picture& picture) {
  const ViewVolume volume(view);
  std::vector<Drawn> drawn;
  for (const RenderItem& item : list.items)
    if (item.index < hierarchy.nodes.size()) drawn.push_back({item.index, item.pointCount, 0.0});
  const auto before = [](const Drawn& a, std::uint32_t node) { return a.node < node; };
  std::sort(drawn.begin(), drawn.end(), [](const Drawn& a, const Drawn& b) { return a.node < b.node; });
  const auto find = [&](std::size_t end, std::uint32_t node) -> const Drawn* {
    const auto last = drawn.begin() + static_cast<std::ptrdiff_t>(end);
    const auto found = std::lower_bound(drawn.begin(), last, node, before);
    return found != last && found->node == node ? &*found : nullptr;
  };

  double widest = 0.0;
  const auto see = [&](std::uint32_t node, double density) {
    const Contour contour = contourOf(hierarchy.nodes[node]);
    const double reach = static_cast<double>(index.reach[node]);
    if (!contourInView(contour, reach, volume)) return;
    const ContourOnScreen screen = projectContour(contour, reach, volume);
    if (screen.extentPx < SelectionOptions{}.minimumPixels) return;
    const double spacing = screen.pixelsPerMetre * std::sqrt(screen.facing / density);
    if (spacing > widest && !hiddenIn(picture, view, contour, reach)) widest = spacing;
  };
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    Drawn& d = drawn[i];
    const NodeRecord& record = hierarchy.nodes[d.node];
    if (record.pointCount == 0) continue;
    const Contour contour = contourOf(record);
    const ContourOnScreen screen = projectContour(contour, static_cast<double>(index.reach[d.node]), volume);
    const Drawn* parent = d.node > 0 ? find(i, index.parent[d.node]) : nullptr;  // its record comes first
    d.density = (parent != nullptr ? parent->density : 0.0) +
                d.points / (areaPerPoint(record, contour, screen) * record.pointCount);
    if (d.points < record.pointCount) see(d.node, d.density);
  }
  for (const Drawn& d : drawn) {
    const NodeRecord& record = hierarchy.nodes[d.node];
    if (d.points < record.pointCount) continue;
    for (int k = 0; k < std::popcount(record.childMask); ++k)
      if (const std::uint32_t child = record.firstChild + static_cast<std::uint32_t>(k);
          find(drawn.size(), child) == nullptr)
        see(child, d.density);
  }
  return widest;
}

}  // namespace strata
