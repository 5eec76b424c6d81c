#pragma once
#include <optional>
#include <vector>

#include "converter/control.h"
#include "core/box.h"
#include "io/scan/point_source.h"

namespace strata {

/// The place of a source's points, measured because its header does not say.
struct MeasuredExtent {
  Box bounds;                     ///< of the finite points, relative to the source's origin
  double typicalMagnitude = 0.0;  ///< median of the points' largest |coordinate|, as a power of two; the origin's own
                                  ///< points do not count
  double typicalExtent = 0.0;     ///< longest side of the box that holds the middle 98 % of the points on each axis
};

/// The extents of all sources of a conversion.
struct MeasuredExtents {
  std::vector<std::optional<MeasuredExtent>> sources;  ///< by source; empty where its header is believed
  bool all = false;                                    ///< no header is believed any more
};

/// True when the bounds in the header of the source can be used as they are.
bool headerBoundsUsable(const SourceInfo& info);

/// Reads the points of the sources whose headers cannot be used, or with `all` of every source, once for their extent,
/// with `threads` threads over the parts of a source. Throws Error and Stopped.
MeasuredExtents measureExtents(const Sources& sources, bool all, int threads, const ConvertControl& control);

}  // namespace strata
