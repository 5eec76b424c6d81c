#pragma once
#include <cstdint>
#include <vector>

#include "io/store/store.h"

namespace strata {

/// Values that the walk and the cache need beyond the records: 8 bytes per node, made once when a store is opened.
struct HierarchyIndex {
  std::vector<std::uint32_t> parent;  ///< index of each node's parent; kNoParent for the root
  /// Metres by which each node's contour has to be grown on all sides to hold the contours of everything below it. A
  /// contour bounds the node's own points alone: a lamp post in a child may stick out of the flat ground above it.
  std::vector<float> reach;

  static constexpr std::uint32_t kNoParent = 0xffffffffu;
};

/// Children whose index does not follow their parent's, or lies beyond the end, get no parent: records may be damaged.
HierarchyIndex indexHierarchy(const Hierarchy& hierarchy);

}  // namespace strata
