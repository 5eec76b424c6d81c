#pragma once
#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

#include "converter/distribute/attribute_stats.h"
#include "converter/distribute/packed_points.h"
#include "converter/distribute/runs.h"
#include "converter/options.h"
#include "converter/survey/survey.h"

namespace strata {

/// Points of one cell of the octree, waiting in the temporary file: some neighbouring cells of a set. Their order is
/// that of the input, whatever thread read them: that is what makes a conversion repeatable.
struct Bucket {
  NodeKey cell;
  std::uint64_t points = 0;
  std::size_t set = 0;  ///< index into Distribution::sets
  std::size_t firstCell = 0, endCell = 0;
  bool sliced = false;  ///< of the deepest level, and above the point limit
};

/// Result of reading every input (design section 5, stage 2).
struct Distribution {
  std::deque<RunSet> sets;      ///< the first holds all points; the others what of it had to be split
  std::vector<Bucket> buckets;  ///< disjoint cells in Morton order, within the point limit but for sliced ones
  Box bounds;                   ///< tight, in grid integers
  std::uint64_t points = 0;
  std::vector<std::uint64_t> sourcePoints;  ///< kept, by source
  std::vector<std::uint64_t> sourceSkipped;
  std::vector<AttributeRange> ranges;  ///< by attribute of the layout
  bool outsideCube = false;            ///< a header lied: points lie outside the cube; there are no buckets
};

/// What the stages share to put points aside and to remember how far they are.
struct Workspace {
  Spill& spill;
  Journal& journal;
};

/// Reads all sources, in parallel over their parts, into cells of the octree; then splits cells of more than
/// `bucketLimit` points and merges small neighbours up to it. What the journal says was done is not done again. In
/// memory at any time: a run of points a thread, within a quarter of options.memoryBytes.
Distribution distribute(const std::vector<std::unique_ptr<PointSource>>& sources, const Survey& frame,
                        const PackedFormat& format, std::uint64_t bucketLimit, const ConvertOptions& options,
                        Workspace work, const ConvertControl& control);

/// How large the runs are, and how many threads may collect one at a time, for the memory there is.
struct RunPlan {
  std::size_t runPoints = 0;
  int workers = 1;
};
RunPlan planRuns(const PackedFormat& format, const ConvertOptions& options);

}  // namespace strata
