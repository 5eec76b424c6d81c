#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "converter/build/node_builder.h"

namespace strata {

/// Builds the nodes of a cell that cannot be divided, because it is of the deepest level or has all points in one
/// place. The node itself keeps at most kMostSlicePoints points; the others become slices, a chain of only children
/// with the same key (docs/format.md, "hierarchy.bin"). The chain is built from its far end, so that points can come
/// piece by piece: in memory at any time are the points of one slice, whatever the cell holds. Used by one thread.
class SliceBuilder {
 public:
  static constexpr std::uint32_t kMostSlicePoints = 1u << 18;

  /// `points` is the number of points that are going to be added. `context` must outlive this.
  SliceBuilder(const BuildContext& context, NodeKey cell, std::uint64_t points);

  /// Adds packed points and returns the slices that are full by now, to be written in this order.
  std::vector<BuiltNode> add(std::span<const std::byte> packed);
  /// The points that the node itself keeps, as BuiltChunk::topPoints.
  std::vector<std::byte> takeTopPoints();
  /// The shape of the slices, or nothing where there are none.
  std::vector<SubtreeShape> takeTopChildren();

 private:
  BuiltNode finishSlice(std::span<const std::byte> packed);

  const BuildContext& context_;
  const NodeKey cell_;
  std::uint64_t slicesLeft_;  ///< to be built; also the number of the next slice in the chain
  std::vector<std::byte> pending_;
  std::optional<SubtreeShape> below_;  ///< of the slice built last
  TreeScratch scratch_;
  EncodeScratch encodeScratch_;
};

}  // namespace strata
