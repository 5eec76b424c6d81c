#pragma once
#include <cstdint>
#include <vector>

#include "io/store/store.h"

namespace strata {

/// What the walk and the cache need beyond the records, made once when a store is opened: 8 bytes a node.
struct HierarchyIndex {
  std::vector<std::uint32_t> parent;  ///< index of the parent; of the root: kNoParent
  /// Metres by which a node's contour has to be grown on all sides to hold the contours of everything below it.
  /// A contour is that of the node's own points; a lamp post in a child may stick out of the flat ground above it.
  std::vector<float> reach;

  static constexpr std::uint32_t kNoParent = 0xffffffffu;
};

/// Records that do not form a tree (a child index that does not follow its parent) are left without a parent.
HierarchyIndex indexHierarchy(const Hierarchy& hierarchy);

}  // namespace strata
