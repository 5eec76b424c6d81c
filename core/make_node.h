#pragma once
#include <memory>
#include <span>

#include "core/node_data.h"

namespace strata {

/// A node of points that are in memory, in their order, on a grid of `step` metres, in batches of at most
/// `batchPoints`. Coordinates are kept to the grid exactly, in as many planes as that takes or `planes` where it is not
/// 0. It has positions only.
std::shared_ptr<NodeData> makeNodeOf(NodeKey key, std::span<const glm::dvec3> points, double step,
                                     std::uint32_t batchPoints = Batch::kMaxPoints, int planes = 0);

}  // namespace strata
