#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "converter/control.h"
#include "converter/options.h"
#include "core/box.h"

namespace strata {

/// The expected cost of a conversion.
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

/// Opens the scans and converts two samples of them, one of about a million points spread over all of them and one of a
/// quarter of those, to a folder that it removes again. Store, temporary disk and time follow from the larger sample;
/// the difference between the two shows how points take fewer bytes where they are closer. `options.output` may be
/// empty. Throws Error for scans that convert() would refuse.
ConversionPlan planConversion(const ConvertOptions& options, const ConvertControl& control);

/// The plan for people, in about ten lines.
std::string planText(const ConversionPlan& plan, const ConvertOptions& options);
/// The plan as one JSON object in one line.
std::string planJson(const ConversionPlan& plan);

}  // namespace strata
