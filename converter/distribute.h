#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "converter/attribute_stats.h"
#include "converter/options.h"
#include "converter/packed_points.h"
#include "converter/spill.h"
#include "converter/survey.h"

namespace strata {

/// Points of one cell of the octree, waiting in the spill. Blocks stand in the order of the input, whatever thread
/// read them: that is what makes a conversion repeatable.
struct Bucket {
  struct Block {
    std::uint64_t sequence = 0;  ///< place of its points in the order of the input
    Spill::Handle handle;
  };
  NodeKey cell;
  std::uint64_t points = 0;
  std::vector<Block> blocks;  ///< sorted by sequence
};

/// Result of reading every input (design section 5, stage 2).
struct Distribution {
  std::vector<Bucket> buckets;  ///< disjoint cells in Morton order, none above the point limit
  Box bounds;                   ///< tight, in grid integers
  std::uint64_t points = 0;
  std::vector<std::uint64_t> sourcePoints;  ///< kept, by source
  std::vector<std::uint64_t> sourceSkipped;
  std::vector<AttributeRange> ranges;  ///< by attribute of the layout
  bool outsideCube = false;            ///< a header lied: points lie outside the cube; the buckets are incomplete
};

/// Reads all sources, in parallel over their parts, into cells of the octree; then splits cells of more than
/// `bucketLimit` points and merges small neighbours up to it. In memory at any time: a slab of points a thread.
Distribution distribute(const std::vector<std::unique_ptr<PointSource>>& sources, const Survey& frame,
                        const PackedFormat& format, std::uint64_t bucketLimit, const ConvertOptions& options,
                        Spill& spill, const ConvertControl& control);

}  // namespace strata
