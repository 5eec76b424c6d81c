#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace strata {

/// Morton keys of points inside a node's cube, ascending; equal keys stand in the order of the input. A key has
/// 3 bits for each of `levels` halvings of the cube.
struct SortedKeys {
  std::span<const std::uint64_t> keys;
  int levels = 0;
};

/// The points that a node keeps when it cannot keep all: the one nearest to the centre of each occupied cell of the
/// finest grid with at most `capacity` cells, then as many of the next finer grid's cells, evenly spread over the
/// Morton order, as fill the capacity. Indices into `points`, ascending.
/// Stands where Kanzok 2015, 3.1 has the adaptive n-tree: cells are octants of the cube, not of the principal frame.
std::vector<std::uint32_t> selectRepresentatives(const SortedKeys& points, std::size_t capacity);

/// Level order of all `points`: level l adds to each occupied cell of the cube's 2^l grid that has no point yet the
/// one nearest to the cell's centre. Inside a level the points come in 16 interleaved passes over the Morton order, so
/// that a prefix that ends inside a level is even as well; batches are a little wider for it.
struct LevelOrder {
  std::vector<std::uint32_t> order;   ///< indices into the points
  std::vector<std::uint32_t> prefix;  ///< points up to and including level i; at most NodeRecord::kMaxPrefixes,
                                      ///< the last one counts all
  double spacing = 1.0;               ///< typical distance of neighbours, in sides of the cube
};
LevelOrder levelOrder(const SortedKeys& points);

/// Occupied cells of the grids of 2^0, 2^1, ... 2^levels cells along each axis.
std::vector<std::uint32_t> occupiedCells(const SortedKeys& points);

}  // namespace strata
