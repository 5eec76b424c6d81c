#pragma once
#include <memory>
#include <span>

#include "core/node_data.h"

namespace strata {

/// Makes a node out of points in memory, in their order, rounded to a grid of `step` metres, in batches of at most
/// `batchPoints`. It has positions only, in `planes` planes, or for 0 in the fewest planes that keep the grid exactly.
std::shared_ptr<NodeData> makeNodeOf(NodeKey key, std::span<const glm::dvec3> points, double step,
                                     std::uint32_t batchPoints = Batch::kMaxPoints, int planes = 0);

}  // namespace strata
