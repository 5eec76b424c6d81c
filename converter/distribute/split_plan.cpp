#include "converter/distribute/split_plan.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace strata {
namespace {

/// A cell with this share of its set's points is likely to hold them in a corner again.
constexpr double kDenseShare = 0.75;

/// Cuts the cells of one set, and of the sets that its cells are split into, into chunks.
class ChunkCutter {
 public:
  ChunkCutter(const std::deque<RunSet>& sets, const SplitPlan& plan, std::uint64_t chunkPoints)
      : sets_(sets), plan_(plan), limit_(chunkPoints) {}

  void cutSet(std::size_t set) {
    const std::vector<std::uint64_t>& points = sets_[set].points;
    std::vector<std::uint64_t> before(points.size() + 1);  // points of all cells before
    std::partial_sum(points.begin(), points.end(), before.begin() + 1);
    cutNode(set, before, 0, 0);
  }
  std::vector<Chunk> take() { return std::move(chunks_); }

 private:
  /// Cuts the node with Morton index `index` among those `depth` levels below the set's parent.
  void cutNode(std::size_t set, const std::vector<std::uint64_t>& before, int depth, std::size_t index) {
    const CellGrid& grid = sets_[set].grid;
    const int bitsBelow = 3 * (grid.levels - depth);
    const std::size_t first = index << bitsBelow, end = (index + 1) << bitsBelow;
    Chunk chunk{{grid.parent.code << (3 * depth) | index}, before[end] - before[first], set, first, end, false};
    if (chunk.points == 0) return;
    if (chunk.points <= limit_) {
      chunks_.push_back(chunk);
      return;
    }
    if (bitsBelow > 0) {
      for (std::size_t octant = 0; octant < 8; ++octant) cutNode(set, before, depth + 1, index << 3 | octant);
      return;
    }
    const Split* split = plan_.find(set, first);
    if (split != nullptr && split->how.levels > 0) {
      cutSet(split->newSet);
      return;
    }
    if (split != nullptr) chunk.cell = split->how.parent;
    chunk.sliced = true;
    chunks_.push_back(chunk);
  }

  const std::deque<RunSet>& sets_;
  const SplitPlan& plan_;
  const std::uint64_t limit_;
  std::vector<Chunk> chunks_;
};

}  // namespace

int SplitLimits::levelsBelow(NodeKey cell) const { return std::min(NodeKey::kDeepestLevel, cubeBits) - cell.level(); }

std::vector<CrowdedCell> crowdedCells(const RunSet& set, const SplitLimits& limits) {
  const std::uint64_t all = std::accumulate(set.points.begin(), set.points.end(), std::uint64_t{0});
  std::vector<CrowdedCell> crowded;
  for (std::size_t cell = 0; cell < set.points.size(); ++cell)
    if (set.points[cell] > limits.chunkPoints && limits.levelsBelow(set.grid.cell(cell)) > 0)
      crowded.push_back({cell, static_cast<double>(set.points[cell]) >= kDenseShare * static_cast<double>(all)});
  return crowded;
}

NodeKey smallestCell(NodeKey cell, const std::array<std::uint64_t, 3>& low, const std::array<std::uint64_t, 3>& high,
                     const SplitLimits& limits) {
  for (int bit = limits.cubeBits - cell.level() - 1; bit >= 0 && limits.levelsBelow(cell) > 0; --bit) {
    int octant = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if ((low[axis] >> bit) != (high[axis] >> bit)) return cell;
      octant = octant << 1 | static_cast<int>(low[axis] >> bit & 1);
    }
    cell = cell.child(octant);
  }
  return cell;
}

int levelsOfSplit(std::uint64_t points, NodeKey parent, const SplitLimits& limits) {
  // Each level of a surface has a quarter of the points in a cell; one level more makes up for uneven ones.
  const double ratio = static_cast<double>(points) / static_cast<double>(limits.chunkPoints);
  const int wanted = static_cast<int>(std::ceil(std::log2(ratio) * 0.5)) + 1;
  const int most = std::min(CellGrid::kMostLevels, limits.levelsBelow(parent));
  return most > 0 ? std::clamp(wanted, 1, most) : 0;
}

void SplitPlan::add(const SplitRecord& how, std::deque<RunSet>& sets) {
  splits_[{how.set, how.cell}] = {how, sets.size()};
  if (how.levels > 0) sets.emplace_back(CellGrid(how.parent, how.levels, cubeBits_));
}

const Split* SplitPlan::find(std::size_t set, std::size_t cell) const {
  const auto found = splits_.find({set, cell});
  return found == splits_.end() ? nullptr : &found->second;
}

std::vector<Split> SplitPlan::ofSet(std::size_t set) const {
  std::vector<Split> found;
  for (auto at = splits_.lower_bound({set, 0}); at != splits_.end() && at->first.set == set; ++at)
    found.push_back(at->second);
  return found;
}

std::vector<Chunk> chunksOf(const std::deque<RunSet>& sets, const SplitPlan& plan, std::uint64_t chunkPoints) {
  ChunkCutter cutter(sets, plan, chunkPoints);
  cutter.cutSet(0);
  return cutter.take();
}

}  // namespace strata
