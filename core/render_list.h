#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "core/node_data.h"
#include "core/view.h"

namespace strata {

/// One node to draw: the first `pointCount` points of its level order.
struct RenderItem {
  static constexpr std::uint32_t kNoIndex = 0xffffffffu;

  std::shared_ptr<const NodeData> node;
  std::uint32_t pointCount = 0;
  std::uint32_t index = kNoIndex;  ///< the node's record in its store's hierarchy; kNoIndex for a node of no store
};

/// The nodes that one LOD pass decided to draw. This is the only thing that lod hands to render. The id of a point in a
/// picture is the sum of the pointCount of the items before its own, plus its place in the node.
struct RenderList {
  View view;                       ///< the view that the list was selected for
  std::vector<RenderItem> items;   ///< the order depends on nothing but the view and the resident nodes
  std::uint64_t pointCount = 0;    ///< sum over items; kept under 2^32 - 1
  std::uint32_t missingNodes = 0;  ///< wanted nodes that are not resident; their parents are drawn instead
  std::uint32_t coarseNodes = 0;   ///< items drawn with fewer position bits or planes than wanted
  std::uint64_t serial = 0;        ///< counts LOD passes
};

}  // namespace strata
