#include "viewer/tools/node_shapes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/picture/colour_map.h"
#include "viewer/camera/camera_control.h"

namespace strata {
namespace {

/// The edges of a box whose corner number i is corner(i): bit k of i says on which side of axis k it lies.
template <typename Corner>
std::vector<Edge> boxEdges(Corner corner) {
  std::vector<Edge> edges;
  for (int i = 0; i < 8; ++i)
    for (const int bit : {1, 2, 4})
      if ((i & bit) == 0) edges.emplace_back(corner(i), corner(i | bit));
  return edges;
}

}  // namespace

std::vector<Edge> contourEdges(const NodeRecord& record) {
  const glm::dvec3 centre(record.centre[0], record.centre[1], record.centre[2]);
  return boxEdges([&](int i) {
    glm::dvec3 corner = centre;
    for (int axis = 0; axis < 3; ++axis)
      for (int c = 0; c < 3; ++c)
        corner[c] += (i >> axis & 1 ? 1.0 : -1.0) * static_cast<double>(record.halfAxis[axis][c]);
    return corner;
  });
}

std::uint32_t contourColour(const NodeRecord& record) {
  switch (static_cast<ContourClass>(record.contourClass)) {
    case ContourClass::linear:
      return packColour(240, 90, 80);
    case ContourClass::planar:
      return packColour(90, 210, 110);
    case ContourClass::volumetric:
      break;
  }
  return packColour(90, 150, 250);
}

std::vector<Edge> frustumEdges(const View& view, double depth) {
  const glm::dvec2 corners[4] = {{0.0, 0.0},
                                 {static_cast<double>(view.width), 0.0},
                                 {static_cast<double>(view.width), static_cast<double>(view.height)},
                                 {0.0, static_cast<double>(view.height)}};
  std::vector<Edge> edges;
  for (int i = 0; i < 4; ++i) {
    const glm::dvec3 far = worldPoint(view, corners[i], depth);
    edges.emplace_back(far, worldPoint(view, corners[(i + 1) % 4], depth));
    edges.emplace_back(worldPoint(view, corners[i], std::min(view.nearPlane, depth)), far);
  }
  return edges;
}

void drawCoarseDepth(std::span<const float> depths, Picture& picture) {
  const int side = static_cast<int>(std::lround(std::sqrt(static_cast<double>(depths.size()))));
  picture.width = picture.height = side;
  picture.colour.assign(depths.size(), packColour(24, 26, 30));
  double nearest = std::numeric_limits<double>::infinity(), farthest = 0.0;
  for (const float depth : depths)
    if (std::isfinite(depth) && depth > 0.0f) {
      nearest = std::min(nearest, static_cast<double>(depth));
      farthest = std::max(farthest, static_cast<double>(depth));
    }
  const double span = std::max(std::log(farthest / nearest), 1e-6);
  for (std::size_t i = 0; i < depths.size(); ++i) {
    if (!std::isfinite(depths[i]) || !(depths[i] > 0.0f)) continue;
    const double t = 1.0 - std::log(static_cast<double>(depths[i]) / nearest) / span;
    const int grey = 70 + static_cast<int>(std::lround(185.0 * std::clamp(t, 0.0, 1.0)));
    picture.colour[i] = packColour(grey, grey, grey);
  }
}

}  // namespace strata
