#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

namespace strata {

/// The smallest and the largest value of an attribute; empty while min > max.
struct ValueRange {
  double min = std::numeric_limits<double>::infinity();
  double max = -std::numeric_limits<double>::infinity();
};

/// Statistics of the attributes of some points.
struct AttributeCounts {
  std::uint64_t points = 0;
  std::vector<ValueRange> ranges;          ///< by attribute of the layout
  std::vector<std::uint64_t> intensities;  ///< histogram of all 65536 values; empty without intensity
};

/// How many points of one source are kept, and how many are not because their coordinates are not finite.
struct SourceCount {
  std::uint64_t source, kept, skipped;
};

/// Statistics of the points of some parts.
struct PointCounts {
  std::array<std::uint64_t, 3> low{}, high{};  ///< bounds in grid integers
  std::vector<SourceCount> sources;            ///< a source may come several times
  AttributeCounts attributes;
};

}  // namespace strata
