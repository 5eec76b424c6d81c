#pragma once
#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <vector>

#include "converter/distribute/chunks.h"
#include "converter/journal/records.h"

/// Decides how cells with too many points are split, from counts alone. Reading and moving points is split.cpp's work.

namespace strata {

/// The limits of chunks and cells.
struct SplitLimits {
  std::uint64_t chunkPoints = 0;
  int cubeBits = 0;

  /// Levels that are possible below a cell.
  int levelsBelow(NodeKey cell) const;
};

/// A cell that has to be split.
struct CrowdedCell {
  std::size_t cell = 0;  ///< index in the grid of its set
  bool dense = false;    ///< it holds most points of its set, so that they are likely to lie in a corner of it, too
};

/// The cells of a set with more points than a chunk may have that are not of the deepest level, ascending.
std::vector<CrowdedCell> crowdedCells(const RunSet& set, const SplitLimits& limits);

/// The smallest cell inside `cell` that holds a box of grid integers.
NodeKey smallestCell(NodeKey cell, const std::array<std::uint64_t, 3>& low, const std::array<std::uint64_t, 3>& high,
                     const SplitLimits& limits);

/// Returns how many levels below `parent` the cells of its new run set lie, for a cell with `points` points. Returns 0
/// when `parent` cannot be divided.
int levelsOfSplit(std::uint64_t points, NodeKey parent, const SplitLimits& limits);

/// A cell that is split, and the set that its points go to.
struct Split {
  SplitRecord how;
  std::size_t newSet = 0;  ///< index into the run sets; meaningless where `how.levels` is 0
};

/// All splits, by the cell that is split.
class SplitPlan {
 public:
  explicit SplitPlan(int cubeBits) : cubeBits_(cubeBits) {}
  /// Adds a split and, where it has levels, its run set at the end of `sets`.
  void add(const SplitRecord& how, std::deque<RunSet>& sets);
  /// Returns nullptr where the cell is not split.
  const Split* find(std::size_t set, std::size_t cell) const;
  /// The splits of the cells of a set, in the order of the cells.
  std::vector<Split> ofSet(std::size_t set) const;

 private:
  struct SplitCell {
    std::uint64_t set, cell;
    auto operator<=>(const SplitCell&) const = default;
  };
  const int cubeBits_;
  std::map<SplitCell, Split> splits_;
};

/// The largest cells whose points stay within the limit, in Morton order, and the cells that cannot be split.
std::vector<Chunk> chunksOf(const std::deque<RunSet>& sets, const SplitPlan& plan, std::uint64_t chunkPoints);

}  // namespace strata
