#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "converter/build/chunk_builder.h"
#include "converter/build/node_builder.h"

namespace strata {

/// A cell that cannot be divided: of the deepest level, or with all points in one place. Its node keeps at most
/// kMostSlicePoints; the rest are slices, a chain of only children with the same key (docs/format.md, "hierarchy.bin").
/// Built from the far end of the chain, so that points can come piece by piece: in memory at any time are those of one
/// slice, whatever the cell holds.
class SliceBuilder {
 public:
  static constexpr std::uint32_t kMostSlicePoints = 1u << 18;

  /// `points` is how many are going to be added.
  SliceBuilder(const BuildFrame& frame, NodeKey cell, std::uint64_t points);

  /// Adds packed points; returns the slices that are full by now, to be written.
  std::vector<BuiltNode> add(std::span<const std::byte> packed);
  /// The points that the node itself keeps, as BuiltChunk has them, and the shape of its slices (none, or one).
  std::vector<std::byte> takeTopPoints();
  std::vector<SubtreeShape> takeTopChildren();

 private:
  BuiltNode finishSlice(std::span<const std::byte> packed);

  const BuildFrame& frame_;
  const NodeKey cell_;
  std::uint64_t slicesLeft_;  ///< also the number of the next one
  std::vector<std::byte> pending_;
  std::optional<SubtreeShape> below_;
  TreeScratch scratch_;
  EncodeScratch encodeScratch_;
};

}  // namespace strata
