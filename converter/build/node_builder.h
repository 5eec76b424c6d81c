#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "converter/build/contour.h"
#include "converter/build/sampling.h"
#include "converter/distribute/packed_points.h"
#include "io/store/node_codec.h"
#include "io/store/store.h"

namespace strata {

/// What all node building needs to know; constant over a conversion.
struct BuildFrame {
  StoreInfo info;  ///< layout, grid, cubeBits, colourShift and nodePoints are set
  PackedFormat format;
  Sampling sampling = Sampling::ntree;
  LodColour lodColour = LodColour::first;

  /// Nodes with children have colours of their own to be drawn in.
  bool averages() const { return lodColour == LodColour::average && info.layout.find(attribute::kRgb) >= 0; }
  glm::dvec3 position(const std::int64_t (&grid)[3]) const {
    return info.grid.offset + info.grid.scale * glm::dvec3(grid[0], grid[1], grid[2]);
  }
};

/// How grid integers become the LocalPoints of a cell: seen from its corner, and halved until 31 bits hold them.
struct CellFrame {
  CellFrame(const BuildFrame& frame, NodeKey cell);

  std::int64_t inside;   ///< mask of the bits below the cell's corner
  int bits;              ///< of a local integer: the cell spans 2^bits
  int shift;             ///< local = (grid & inside) >> shift
  glm::dvec3 corner{0};  ///< world
  glm::dvec3 step{1};    ///< metres a local integer stands for

  std::int32_t local(std::int64_t grid) const { return static_cast<std::int32_t>((grid & inside) >> shift); }
  /// Moments about the corner as LevelOrder has them, in world coordinates.
  Moments world(Moments moments) const {
    moments.mean += corner;
    return moments;
  }
};

/// A node ready to be written.
struct BuiltNode {
  NodeRecord record{};  ///< all but firstChild, childMask and offset; of a slice, firstChild is its number until linked
  std::vector<std::byte> payload;
};

/// A finished node, and what its parent has to know.
struct FinishedNode {
  BuiltNode node;
  SubtreeShape shape;
};

/// Appends the positions of packed records, which stand `stride` bytes apart, to `columns`, in the cell's integers.
void appendLocal(const BuildFrame& frame, const CellFrame& cell, std::span<const std::byte> records, std::size_t stride,
                 std::vector<std::int32_t> (&columns)[3]);

/// Replaces `out` by copies of packed records, `which` of them in this order. They stand `stride` bytes apart.
void gather(const BuildFrame& frame, const std::byte* records, std::size_t stride, std::span<const std::uint32_t> which,
            NodePoints& out);

/// Packs and describes a node. `points` stand in the order that `levels` describes (may be none); their own levels are
/// set where the codec may sort inside them. `moments` are of the points and everything below, world; `children` are
/// the shapes of the node's subtrees.
FinishedNode finishNode(const BuildFrame& frame, NodeKey key, NodePoints& points, const LevelOrder& levels,
                        const Moments& moments, std::span<const SubtreeShape> children, EncodeScratch& scratch);

}  // namespace strata
