#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "core/box.h"
#include "core/render_list.h"

namespace strata::test {

/// Makes a node of `points` in their order, on a grid of `step` metres, in batches of at most `batchPoints`. It has as
/// many planes as it takes to keep coordinates exact on the grid, or `planes` if that is not 0. Colours, intensities
/// and classes follow from the position.
std::shared_ptr<const NodeData> makeNode(NodeKey key, const std::vector<glm::dvec3>& points, double step,
                                         std::uint32_t batchPoints = Batch::kMaxPoints, int planes = 0);

/// A list that draws every point of each node.
RenderList makeList(const std::vector<std::shared_ptr<const NodeData>>& nodes);

Box boundsOf(const RenderList& list);

/// Makes wavy ground of `count` points over side x side metres around `centre`, with `count` / 4 more points in boxes
/// and clusters on it. The ground is divided into tiles x tiles squares, and each square has two nodes, for low and for
/// high points. Points of a node have no order.
RenderList makeTown(const glm::dvec3& centre, double side, std::uint32_t count, std::uint32_t seed, int tiles = 2);

/// Views of `box` from all around: from afar, from a middle distance and from inside.
std::vector<View> viewsAround(const Box& box, int count, int width, int height);

}  // namespace strata::test
