#pragma once
#include <cstddef>
#include <vector>

#include "converter/build/chunk_scratch.h"
#include "converter/build/node_builder.h"

namespace strata {

/// The subtree of one chunk's cell. Its top node is not built yet, because ancestors still take points out of it.
struct BuiltChunk {
  std::vector<BuiltNode> nodes;           ///< below the top, in depth-first order
  std::vector<std::byte> topPoints;       ///< BuildContext::topPointStride() bytes each
  std::vector<SubtreeShape> topChildren;  ///< shapes of the top's subtrees
};

/// Builds the nodes of `cell` from all of its points (packed, in the order of the input), in memory, top down: a node
/// keeps representatives and hands the rest to its children. `scratch` is storage to be used again.
BuiltChunk buildChunk(const BuildContext& context, NodeKey cell, std::vector<std::byte> points, ChunkScratch& scratch);

/// The memory that building a chunk takes for each of its points at its peak, with a scratch that is used again: the
/// points as they come and in order, two sets of columns, the octants and the n-tree. Finished nodes, at most about a
/// point's own size per point, come on top.
inline std::size_t chunkBytesPerPoint(const PackedFormat& format) {
  return 2 * format.stride() + 2 * 16 + 1 + kTreeBytesPerPoint;
}

}  // namespace strata
