#pragma once
#include <cstddef>

#include "converter/distribute/packed_points.h"
#include "converter/options.h"

namespace strata {

/// How large the runs are, and how many threads may collect one at a time.
struct RunPlan {
  std::size_t runPoints = 0;
  int workers = 1;
};

/// Makes the runs and what reading takes fit into a quarter of `options.memoryBytes`.
RunPlan planRuns(const PackedFormat& format, const ConvertOptions& options);

}  // namespace strata
