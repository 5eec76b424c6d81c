#pragma once
#include <cstdint>
#include <vector>

#include "converter/stage_clock.h"
#include "io/store/plane_sizes.h"

namespace strata {

/// The outcome of a conversion and its cost.
struct ConvertReport {
  std::uint64_t points = 0, nodes = 0, skipped = 0;
  std::uint64_t inputBytes = 0, outputBytes = 0, tempPeakBytes = 0;
  std::vector<StageTime> stages;                           ///< in their order
  std::vector<std::uint64_t> nodesByLevel, pointsByLevel;  ///< from the root down
  std::vector<PlaneSize> planes;
};

/// Fills in everything that the published store itself tells: all members but `inputBytes`, `tempPeakBytes` and
/// `stages`.
void reportStore(const Store& store, ConvertReport& report);

}  // namespace strata
