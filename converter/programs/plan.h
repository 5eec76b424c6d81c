#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "converter/options.h"
#include "core/box.h"

namespace strata {

/// What a conversion will take, before it is begun.
struct ConversionPlan {
  std::size_t scans = 0;
  std::uint64_t points = 0, inputBytes = 0;
  Box bounds;                ///< world
  bool boundsKnown = false;  ///< stated by the scans; else those of the sample
  std::string crs;
  std::uint64_t sampledPoints = 0;
  double storeBytes = 0.0, temporaryBytes = 0.0, memoryBytes = 0.0, seconds = 0.0;
  std::vector<std::string> warnings;  ///< disks without enough room
};

/// Opens the scans and converts two samples of them, about a million points spread over all and a quarter of those,
/// to a folder that is removed again. Store, temporary disk and time follow from what the samples took; how a node's
/// points get closer in the full scan, and with it smaller, from the difference between the two.
/// options.output may be empty. Throws Error for scans that convert() would refuse.
ConversionPlan planConversion(const ConvertOptions& options, const ConvertControl& control);

/// For people, and as one JSON object in one line.
std::string planText(const ConversionPlan& plan, const ConvertOptions& options);
std::string planJson(const ConversionPlan& plan);

}  // namespace strata
