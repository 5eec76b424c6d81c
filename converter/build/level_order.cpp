#include "converter/build/level_order.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "io/store/store.h"

namespace strata {
namespace {

using RankCounts = std::array<std::uint32_t, NTree::kRanks>;

/// The rank at which the capacity is reached: all points of lower ranks are kept, and `share` of the `full` points of
/// this rank.
struct Cut {
  std::uint16_t rank = NTree::kRanks - 1;
  std::uint32_t share = 0, full = 0;
};

/// Lowers `counts` from the points of each rank to those that are kept.
Cut cutAt(std::size_t capacity, RankCounts& counts) {
  Cut cut;
  std::size_t kept = 0;
  for (std::size_t rank = 0; rank < counts.size(); ++rank) {
    const std::size_t room = capacity - kept;
    if (counts[rank] > 0) cut = {static_cast<std::uint16_t>(rank), counts[rank], counts[rank]};
    if (counts[rank] >= room) {
      cut.share = counts[rank] = static_cast<std::uint32_t>(room);
      std::fill(counts.begin() + static_cast<std::ptrdiff_t>(rank) + 1, counts.end(), 0);
      break;
    }
    kept += counts[rank];
  }
  return cut;
}

/// Fills in the prefixes of the levels.
void countLevels(const RankCounts& counts, LevelOrder& out) {
  std::uint32_t sum = 0;
  const auto total = static_cast<std::uint32_t>(out.order.size());
  for (std::size_t rank = 0; rank < counts.size() && sum < total; ++rank) {
    sum += counts[rank];
    const bool levelEnds = rank % NTree::kPasses == NTree::kPasses - 1;
    if (levelEnds && out.prefix.size() + 1 < NodeRecord::kMaxPrefixes) out.prefix.push_back(sum);
  }
  if (out.prefix.empty() || out.prefix.back() != total) out.prefix.push_back(total);
}

/// The side of the cells on the finest level that has at least two kept points per cell, scaled down to the side of a
/// cell with one.
double spacingOf(const NTree& tree, const RankCounts& counts, std::size_t kept) {
  std::size_t cells = 1, sum = 0;
  int level = 0;
  for (int l = 0; l < NTree::kBeyond; ++l) {
    for (int pass = 0; pass < NTree::kPasses; ++pass)
      sum += counts[static_cast<std::size_t>(l * NTree::kPasses + pass)];
    if (sum > kept / 2) break;
    cells = sum;
    level = l;
  }
  const double filled = static_cast<double>(cells) / static_cast<double>(kept);
  return std::ldexp(tree.rootSide, -level) * (tree.shape == ContourClass::linear ? filled : std::sqrt(filled));
}

}  // namespace

LevelOrder levelOrder(const LocalPoints& points, std::size_t capacity, TreeScratch& scratch) {
  LevelOrder out;
  if (points.count() == 0) {
    out.prefix = {0};
    return out;
  }
  const NTree tree = buildTree(points, capacity, scratch);
  out.moments = tree.moments;
  RankCounts counts{};
  for (const std::uint16_t rank : tree.ranks) ++counts[rank];
  const Cut cut = cutAt(capacity, counts);

  RankCounts next;
  std::uint32_t kept = 0;
  for (std::size_t rank = 0; rank < counts.size(); ++rank) {
    next[rank] = kept;
    kept += counts[rank];
  }
  out.order.resize(kept);
  std::uint64_t share = 0;  // exceeds cut.full once in cut.full / cut.share points
  for (std::size_t i = 0; i < tree.ranks.size(); ++i) {
    const std::uint16_t rank = tree.ranks[i];
    if (rank > cut.rank) continue;
    if (rank == cut.rank) {
      share += cut.share;
      if (share < cut.full) continue;
      share -= cut.full;
    }
    out.order[next[rank]++] = tree.point(i);
  }
  countLevels(counts, out);
  out.spacing = spacingOf(tree, counts, kept);
  return out;
}

std::vector<std::uint32_t> representedBy(const TreeScratch& scratch, std::size_t count,
                                         std::span<const std::uint32_t> order) {
  constexpr std::uint32_t kNone = 0xffffffff;
  std::vector<std::uint32_t> by(count, kNone);
  for (std::size_t k = 0; k < order.size(); ++k) by[order[k]] = static_cast<std::uint32_t>(k);
  const auto point = [&](std::size_t entry) { return static_cast<std::uint32_t>(scratch.entries[entry]); };
  // A cell of the n-tree is a range of entries, and its representative the first of them.
  std::uint32_t current = kNone;
  for (std::size_t i = 0; i < count && current == kNone; ++i) current = by[point(i)];
  for (std::size_t i = 0; i < count; ++i) {
    if (by[point(i)] != kNone) current = by[point(i)];
    by[point(i)] = current;
  }
  return by;
}

}  // namespace strata
