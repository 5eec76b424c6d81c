#pragma once
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <glm/glm.hpp>

#include "core/picture.h"
#include "core/view.h"
#include "io/store/store.h"

namespace strata {

using Edge = std::pair<glm::dvec3, glm::dvec3>;

/// The twelve edges of a node's contour, in world coordinates.
std::vector<Edge> contourEdges(const NodeRecord& record);
/// Red for a linear contour, green for a planar and blue for a volumetric one, as R | G<<8 | B<<16 | 255<<24.
std::uint32_t contourColour(const NodeRecord& record);

/// The edges of the space that a view sees up to `depth` metres: the far rectangle and the rays to its corners.
std::vector<Edge> frustumEdges(const View& view, double depth);

/// Paints the coarse depth as a picture: nearer is brighter, by the logarithm of the depth, and where nothing hides
/// anything it is dark. `depths` are the rows of a square, infinite where nothing hides anything.
void drawCoarseDepth(std::span<const float> depths, Picture& picture);

}  // namespace strata
