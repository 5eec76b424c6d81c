#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "core/box.h"
#include "core/render_list.h"

namespace strata::test {

/// A node of `points` in their order, on a grid of `step` metres, in batches of at most `batchPoints`. Coordinates are
/// kept to the grid exactly, in as many planes as that takes or `planes` where it is not 0. Colours, intensities and
/// classes follow from the position.
std::shared_ptr<const NodeData> makeNode(NodeKey key, const std::vector<glm::dvec3>& points, double step,
                                         std::uint32_t batchPoints = Batch::kMaxPoints, int planes = 0);

/// Every point of each node.
RenderList makeList(const std::vector<std::shared_ptr<const NodeData>>& nodes);

Box boundsOf(const RenderList& list);

/// Wavy ground of `count` points over side x side metres around `centre`, with `count` / 4 more in boxes and clusters
/// that stand on it. A node holds what is low or high over one of tiles x tiles squares; no order within a node.
RenderList makeTown(const glm::dvec3& centre, double side, std::uint32_t count, std::uint32_t seed, int tiles = 2);

/// Views of `box` from all around: far, middle and from inside.
std::vector<View> viewsAround(const Box& box, int count, int width, int height);

}  // namespace strata::test
