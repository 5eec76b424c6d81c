#pragma once
#include <cstdint>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include <glm/glm.hpp>

#include "core/picture.h"
#include "core/view.h"
#include "io/store/store.h"

namespace strata {

using Edge = std::pair<glm::dvec3, glm::dvec3>;

/// The twelve edges of a node's contour, world.
std::vector<Edge> contourEdges(const NodeRecord& record);
/// Linear red, planar green, volumetric blue: R | G<<8 | B<<16 | 255<<24.
std::uint32_t contourColour(const NodeRecord& record);

/// What a view sees as far as `depth` metres: the far rectangle and the rays to its corners.
std::vector<Edge> frustumEdges(const View& view, double depth);

/// Finds a node's record by its key; of slices of one cell the first.
class NodeFinder {
 public:
  explicit NodeFinder(const Hierarchy& hierarchy);
  /// Null where there is none.
  const NodeRecord* find(NodeKey key) const;

 private:
  const Hierarchy& hierarchy_;
  std::unordered_map<std::uint64_t, std::uint32_t> byKey_;
};

/// The coarse depth as a picture: the nearer the brighter by the logarithm, dark where it is open. `depths` are square,
/// row by row, infinite where open.
void drawCoarseDepth(std::span<const float> depths, Picture& frame);

}  // namespace strata
