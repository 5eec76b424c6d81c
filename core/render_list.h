#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "core/node_data.h"
#include "core/view.h"

namespace strata {

/// One node to draw: the first `pointCount` points of its level order. Holding the pointer pins the node.
struct RenderItem {
  static constexpr std::uint32_t kNoIndex = 0xffffffffu;

  std::shared_ptr<const NodeData> node;
  std::uint32_t pointCount = 0;
  std::uint32_t index = kNoIndex;  ///< the node's record in its store's hierarchy; kNoIndex for a node of no store
};

/// What one LOD pass decided to draw. The only thing that lod hands to render.
/// A point's id in a frame is (sum of the pointCount of the items before) + its index in the node.
struct RenderList {
  View view;                       ///< the view that the list was selected for
  std::vector<RenderItem> items;   ///< in a fixed order for a given view and set of resident nodes
  std::uint64_t pointCount = 0;    ///< sum over items; kept under 2^32 - 1
  std::uint32_t missingNodes = 0;  ///< wanted, but not resident (a parent stands in)
  std::uint32_t coarseNodes = 0;   ///< of the items: drawn with fewer position bits or columns than wanted
  std::uint64_t serial = 0;        ///< counts LOD passes
};

}  // namespace strata
