#pragma once
#include <cstdint>
#include <span>

#include "core/draw_options.h"
#include "core/node_data.h"

namespace strata {

/// The colour of one point by options.colour, whose batch is drawn with `precision`. Overdraw colours pixels, not
/// points; for that mode this is the point's own colour.
std::uint32_t pointColour(const NodeData& node, std::uint32_t point, const DrawOptions& options, Precision precision);

/// The colours of points [firstPoint, firstPoint + out.size()).
void pointColours(const NodeData& node, std::uint32_t firstPoint, const DrawOptions& options, Precision precision,
                  std::span<std::uint32_t> out);

/// The batch that a point belongs to. The node must have batches.
const Batch& batchOf(const NodeData& node, std::uint32_t point);

/// Prefetches the memory that pointColour() will read.
void prefetchColour(const NodeData& node, std::uint32_t point, ColourMode mode);

}  // namespace strata
