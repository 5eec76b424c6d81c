#pragma once
#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "converter/distribute/runs.h"
#include "core/box.h"
#include "core/node_key.h"
#include "io/store/store.h"

namespace strata {

/// A cell with as many points as memory allows to build at once: neighbouring cells of one run set. The order of its
/// points is that of the input, whatever thread read them, so that a conversion is repeatable.
struct Chunk {
  NodeKey cell;
  std::uint64_t points = 0;
  std::size_t set = 0;                     ///< index into Distribution::sets
  std::size_t firstCell = 0, endCell = 0;  ///< the cells of the set that it consists of
  bool sliced = false;                     ///< it cannot be divided although it is above the point limit
};

/// All points of the input in the spill, and how they are cut into chunks.
struct Distribution {
  std::deque<RunSet> sets;    ///< set 0 holds all points; the others hold what had to be split, in the order of splits
  std::vector<Chunk> chunks;  ///< disjoint cells in Morton order; within the point limit unless they are sliced
  Box bounds;                 ///< tight, in grid integers
  std::uint64_t points = 0;
  std::vector<std::uint64_t> sourcePoints;   ///< kept points, by source
  std::vector<std::uint64_t> sourceSkipped;  ///< points that are not kept, by source
  std::vector<AttributeRange> ranges;        ///< by attribute of the layout
  bool outsideCube = false;  ///< a header lied and points lie outside the cube; there are no chunks then
};

}  // namespace strata
