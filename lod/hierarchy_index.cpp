#include "lod/hierarchy_index.h"

#include <algorithm>
#include <bit>

#include "lod/contour.h"

namespace strata {
namespace {

/// The distance of the corner of `inner` that is farthest from `outer`.
double farthestCorner(const Contour& inner, const Contour& outer) {
  double farthest = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    glm::dvec3 point = inner.centre;
    for (std::size_t a = 0; a < 3; ++a)
      point += inner.axis[a] * ((corner >> a & 1) != 0 ? inner.half[a] : -inner.half[a]);
    farthest = std::max(farthest, distanceTo(outer, point));
  }
  return farthest;
}

}  // namespace

HierarchyIndex indexHierarchy(const Hierarchy& hierarchy) {
  const std::size_t count = hierarchy.nodes.size();
  HierarchyIndex index;
  index.parent.assign(count, HierarchyIndex::kNoParent);
  index.reach.assign(count, 0.0f);
  // Backwards, because in breadth-first order everything below a node comes after it.
  for (std::size_t node = count; node-- > 0;) {
    const NodeRecord& record = hierarchy.nodes[node];
    const std::size_t first = record.firstChild;
    const auto children = static_cast<std::size_t>(std::popcount(record.childMask));
    if (children == 0 || first <= node || first + children > count) continue;
    const Contour contour = contourOf(record);
    double reach = 0.0;
    for (std::size_t child = first; child < first + children; ++child) {
      index.parent[child] = static_cast<std::uint32_t>(node);
      const double outside = farthestCorner(contourOf(hierarchy.nodes[child]), contour);
      reach = std::max(reach, outside + static_cast<double>(index.reach[child]));
    }
    // Floats round to nearest, but a reach must not be too short.
    index.reach[node] = static_cast<float>(reach * (1.0 + 1e-6));
  }
  return index;
}

}  // namespace strata
