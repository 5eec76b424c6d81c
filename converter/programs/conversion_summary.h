#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "converter/convert_report.h"

namespace strata {

/// The cost of the whole run of the program.
struct RunCost {
  double seconds = 0.0, cpuSeconds = 0.0;
  std::uint64_t peakMemoryBytes = 0;
};

/// Measures the time and memory since the program's start, except for `seconds`, which the caller fills in.
RunCost runCost();

/// Describes a conversion for people, in at most about 20 lines.
std::string summaryText(const std::string& output, const ConvertReport& report, const RunCost& cost);
/// Describes a conversion as one JSON object in one line.
std::string summaryJson(const ConvertReport& report, const RunCost& cost);

/// {"warning": MESSAGE}
std::string warningJson(const std::string& message);

}  // namespace strata
