#pragma once
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "converter/build/ntree.h"

namespace strata {

/// The representatives of a node in the order in which they are drawn, so that any prefix is an even subsample of the
/// node. Level l of the n-tree adds a point to each occupied cell that has none yet. Inside a level the points come in
/// passes, each of which is an even lattice, and inside a pass in the order of their keys.
struct LevelOrder {
  static constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();

  std::vector<std::uint32_t> order;   ///< indices into the points
  std::vector<std::uint32_t> prefix;  ///< kept points up to and including level i; at most NodeRecord::kMaxPrefixes
                                      ///< entries, and the last one counts all
  double spacing = 0.0;               ///< metres between neighbours when all kept points are drawn
  Moments moments;                    ///< of all points, kept or not; metres about the corner of their cell
};

/// Keeps `capacity` points, or all where there are fewer: all levels up to one, and of the next level as many passes
/// as fit, the last of them thinned evenly. So the leaf depths of the n-tree differ by at most one (Kanzok 2015, 3.1).
/// A function of the points alone; `scratch` then holds the entries of their n-tree.
LevelOrder levelOrder(const LocalPoints& points, std::size_t capacity, TreeScratch& scratch);

/// A point is represented by the kept point in its cell of the n-tree. Returns, for each of `count` points, the index
/// of that kept point in `order`. Call it directly after levelOrder(), with the same `scratch`.
std::vector<std::uint32_t> representedBy(const TreeScratch& scratch, std::size_t count,
                                         std::span<const std::uint32_t> order);

}  // namespace strata
