#pragma once
#include <cstddef>
#include <vector>

#include "converter/build/chunk_scratch.h"
#include "converter/build/node_builder.h"

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
BuiltChunk buildChunk(const BuildFrame& frame, NodeKey cell, std::vector<std::byte> points, ChunkScratch& scratch);

/// Memory that building a chunk takes for each of its points at its peak, with a scratch that is used again: the points
/// as they come and in order, two sets of columns, the octants and the n-tree. Finished nodes (at most about a point's
/// own size each) come on top.
inline std::size_t chunkBytesPerPoint(const PackedFormat& format) {
  return 2 * format.stride() + 2 * 16 + 1 + kTreeBytesPerPoint;
}

}  // namespace strata
