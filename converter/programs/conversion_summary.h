#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "converter/options.h"

namespace strata {

/// What the whole run of the program took.
struct RunCost {
  double seconds = 0.0, cpuSeconds = 0.0;
  std::uint64_t peakMemoryBytes = 0;
};

/// Since the program's start; `seconds` is the caller's to fill in.
RunCost runCost();

/// What a conversion did, for people: at most about 20 lines.
std::string summaryText(const std::string& output, const ConvertReport& report, const RunCost& cost);
/// The same as one JSON object in one line (design section 10).
std::string summaryJson(const ConvertReport& report, const RunCost& cost);

/// {"warning": MESSAGE}
std::string warningJson(const std::string& message);

}  // namespace strata
