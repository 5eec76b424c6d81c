#pragma once
#include <cstdint>
#include <span>

#include "core/draw_options.h"
#include "core/node_data.h"

namespace strata {

/// The colour of one point by options.colour, for every mode but overdraw, which is a pixel's. `precision` is what its
/// batch is drawn with.
std::uint32_t pointColour(const NodeData& node, std::uint32_t point, const DrawOptions& options, Precision precision);

/// The same of points [firstPoint, firstPoint + out.size()).
void pointColours(const NodeData& node, std::uint32_t firstPoint, const DrawOptions& options, Precision precision,
                  std::span<std::uint32_t> out);

/// The batch that a point is in; the node has batches.
const Batch& batchOf(const NodeData& node, std::uint32_t point);

/// Asks the memory for what pointColour() will read.
void prefetchColour(const NodeData& node, std::uint32_t point, ColourMode mode);

}  // namespace strata
