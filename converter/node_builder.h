#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "converter/contour.h"
#include "converter/level_order.h"
#include "converter/packed_points.h"
#include "io/store.h"

namespace strata {

/// What all node building needs to know; constant over a conversion.
struct BuildFrame {
  StoreInfo info;  ///< layout, grid, cubeBits, colourShift and nodePoints are set
  PackedFormat format;

  glm::dvec3 position(const std::int64_t (&grid)[3]) const {
    return info.grid.offset + info.grid.scale * glm::dvec3(grid[0], grid[1], grid[2]);
  }
  /// Halvings of the node's cube that a key can hold.
  int keyLevels(NodeKey cell) const;
  /// Morton key of a packed point inside the cube of `cell`.
  std::uint64_t key(NodeKey cell, const std::byte* record) const;
};

/// A node ready to be written.
struct BuiltNode {
  NodeRecord record{};  ///< all but firstChild, childMask and offset
  std::vector<std::byte> payload;
};

/// A finished node, and what its parent has to know.
struct FinishedNode {
  BuiltNode node;
  SubtreeShape shape;
};

/// Orders, packs and describes the points that a node keeps. `points` are packed records in Morton order (may be
/// none); `children` are the shapes of the node's subtrees.
FinishedNode finishNode(const BuildFrame& frame, NodeKey key, std::span<const std::byte> points,
                        std::span<const SubtreeShape> children);

}  // namespace strata
