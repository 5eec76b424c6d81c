#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "converter/build/build_context.h"
#include "converter/build/level_order.h"
#include "converter/journal/records.h"
#include "io/store/node_codec.h"

namespace strata {

/// A node that is ready to be written.
struct BuiltNode {
  WrittenNode node;  ///< without the offset of its payload
  std::vector<std::byte> payload;
};

/// A finished node, and what its parent has to know.
struct FinishedNode {
  BuiltNode node;
  SubtreeShape shape;
};

/// Appends the positions of packed records, which lie `stride` bytes apart, to `columns`, in the cell's local integers.
void appendLocal(const BuildContext& context, const CellCoordinates& cell, std::span<const std::byte> records,
                 std::size_t stride, std::vector<std::int32_t> (&columns)[3]);

/// Replaces `out` by the packed records with the indices `which`, in this order. The records lie `stride` bytes apart.
void gather(const BuildContext& context, const std::byte* records, std::size_t stride,
            std::span<const std::uint32_t> which, NodePoints& out);

/// The parts of a node.
struct NodeParts {
  NodeKey key;
  NodePoints& points;  ///< in the order of `order`; may be none. finishNode() sets their levels
  const LevelOrder& order;
  Moments moments;                         ///< of the points and everything below, world
  std::span<const SubtreeShape> children;  ///< of the node's subtrees
};
/// Encodes a node and describes it by its record. `scratch` is storage to be used again.
FinishedNode finishNode(const BuildContext& context, const NodeParts& parts, EncodeScratch& scratch);

}  // namespace strata
