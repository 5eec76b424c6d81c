#pragma once
#include <algorithm>
#include <cstddef>
#include <vector>

#include "converter/node_builder.h"

namespace strata {

/// The subtree of one bucket's cell, but for its top node: ancestors still take points out of that one.
struct BuiltChunk {
  std::vector<BuiltNode> nodes;           ///< below the top node, in depth-first order
  std::vector<std::byte> topPoints;       ///< packed, topPointStride() bytes each
  std::vector<SubtreeShape> topChildren;  ///< shapes of the top node's subtrees
};

/// A top node's point is its record and, where colours are averaged, its Represented.
std::size_t topPointStride(const BuildFrame& frame);

/// Builds the nodes of `cell` from all of its points (packed, in the order of the input), in memory, top down
/// (design section 5, stage 3): a node keeps representatives, the rest goes to its children.
BuiltChunk buildChunk(const BuildFrame& frame, NodeKey cell, std::vector<std::byte> points);

/// Memory that building a chunk takes for each of its points at its peak, the points themselves included: the points
/// twice while they are put in order, or the points, two sets of columns and the n-tree's scratch. Finished nodes
/// (at most about a point's own size each) come on top.
inline std::size_t chunkBytesPerPoint(const PackedFormat& format) {
  constexpr std::size_t kColumnBytes = 16;
  return std::max(2 * format.stride() + kColumnBytes, format.stride() + 2 * kColumnBytes + kTreeBytesPerPoint + 1);
}

}  // namespace strata
