#pragma once
#include <cstddef>
#include <vector>

#include "converter/node_builder.h"

namespace strata {

/// The subtree of one bucket's cell, but for its top node: ancestors still take points out of that one.
struct BuiltChunk {
  std::vector<BuiltNode> nodes;           ///< below the top node, in depth-first order
  std::vector<std::byte> topPoints;       ///< packed, in Morton order
  std::vector<SubtreeShape> topChildren;  ///< shapes of the top node's subtrees
};

/// Builds the nodes of `cell` from all of its points (packed, in the order of the input), in memory, top down
/// (design section 5, stage 3): a node keeps representatives, the rest goes to its children.
/// Holds the points and 24 bytes for each of them.
BuiltChunk buildChunk(const BuildFrame& frame, NodeKey cell, std::vector<std::byte> points);

/// Sorts by key, keeping the order of equal keys. `index[i]` starts as i and moves along.
void sortByKey(std::vector<std::uint64_t>& keys, std::vector<std::uint32_t>& index, int keyBits);

}  // namespace strata
