#pragma once
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "converter/build/ntree.h"

namespace strata {

/// The points that a node keeps, in the order in which they are drawn: any prefix is an even subsample of the node.
/// Level l of the n-tree adds a point to each occupied cell that has none yet. Inside a level the points come in the
/// tree's passes, each an even lattice of its own, and inside a pass in the order of its keys.
struct LevelOrder {
  static constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();

  std::vector<std::uint32_t> order;   ///< indices into the points
  std::vector<std::uint32_t> prefix;  ///< kept points up to and including level i; at most NodeRecord::kMaxPrefixes,
                                      ///< the last one counts all
  double spacing = 0.0;               ///< metres between neighbours when all kept points are drawn
  double rootSide = 0.0;              ///< of the n-tree, metres
  Moments moments;                    ///< of all points, kept or not; about the corner of their cube, in metres
};

/// Keeps `capacity` points, or all where there are no more: all levels up to one, and of the next one as many passes
/// as fit, the last of them thinned evenly. So leaf depths of the n-tree differ by at most one (Kanzok 2015, 3.1).
LevelOrder levelOrder(const LocalPoints& points, std::size_t capacity, TreeScratch& scratch);

}  // namespace strata
