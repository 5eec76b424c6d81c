#pragma once
#include "converter/options.h"
#include "io/scan/point_source.h"

namespace strata {

/// Where the points of a source lie, when its header cannot tell.
struct MeasuredSource {
  Box bounds;  ///< of finite points, relative to the source's origin
  double typicalMagnitude =
      0;  ///< median over the points but for the origin of the largest |coordinate|, as a power of two
  double typicalExtent = 0;  ///< longest side of the box that holds the middle 98 % of the points on each axis
};

/// Reads the points of a source once for their extent; in parallel over its parts.
MeasuredSource measureSource(const PointSource& source, int threads, const ConvertControl& control);

}  // namespace strata
