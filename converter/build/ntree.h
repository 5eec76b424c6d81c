#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

#include "converter/build/local_points.h"
#include "converter/memory/buffer.h"

namespace strata {

/// Memory for ordering one node, to be used for the next one too. Together with what averaging colours takes for a
/// moment it is kTreeBytesPerPoint per point.
struct TreeScratch {
  Buffer<std::uint64_t> entries, spare;
  Buffer<std::uint16_t> ranks;
};
inline constexpr std::size_t kTreeBytesPerPoint = 22;

/// The adaptive n-tree of a node (Kanzok 2015, 3.1): n = 2, 4 or 8 as its points lie along a line, a plane or in a
/// volume (his eq. 1); cells are squares or cubes along the principal axes. It has no pointers: it is the points in the
/// order of a key with log2 n bits per level, and for each point the level at which it becomes a representative.
///
/// Every cell has an aim point, and its representative is found by going down towards it: into the child that holds
/// the aim point or, where that is empty, into the nearest child with points. Deviation from Kanzok: the aim points lie
/// at a third of the cell's sides, from the lower and from the upper end in turn by level, not in the middle. So a cell
/// and one of its children aim at the same place, and the representatives of every full level form one regular lattice
/// (docs/decisions/0007-nested-lattices.md). Keys count a cell's children from the one that holds the aim
/// point, so the representative of any cell is the first of its points.
struct NTree {
  static constexpr int kBeyond = 31;  ///< the level of points that no cell tells apart
  static constexpr int kPasses = 32;
  static constexpr int kRanks = (kBeyond + 1) * kPasses;

  Moments moments;  ///< of all points, as momentsOf() gives them
  ContourClass shape = ContourClass::volumetric;
  double rootSide = 0.0;  ///< metres
  /// Key << 32 | index of the point, ascending.
  std::span<const std::uint64_t> entries;
  /// Level * kPasses + pass of the point in each entry. A level's new points come in passes, each an even lattice where
  /// points are dense: at most 12 passes of a plane, 14 of a volume, 4 of a line.
  std::span<const std::uint16_t> ranks;

  std::uint32_t point(std::size_t entry) const { return static_cast<std::uint32_t>(entries[entry]); }
};

/// Builds the tree of at least one point. The result lives in `scratch`. At least `wanted` points are told apart where
/// their coordinates differ: keys have 24 to 30 bits, and as many again where those do not suffice.
NTree buildTree(const LocalPoints& points, std::size_t wanted, TreeScratch& scratch);

}  // namespace strata
