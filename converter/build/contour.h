#pragma once
#include <array>
#include <cstdint>

#include "converter/subtree_shape.h"

namespace strata {

/// How stretched points are, by Kanzok 2015, eq. 1.
struct Anisotropy {
  double linear = 0.0, planar = 0.0, spherical = 1.0;  ///< his c_l, c_p and c_s
  /// The principal axes, of unit length, longest first.
  std::array<glm::dvec3, 3> axes{glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1)};
};
Anisotropy anisotropy(const Moments& moments);

/// Classifies by Kanzok 2015, 3.1: volumetric if c_s > 0.03, planar if only c_p > 0.03, linear otherwise.
ContourClass classify(const Anisotropy& anisotropy);

/// Fits the contour of a subtree around its principal axes. `moments` and `box` are those of the whole subtree, world;
/// `visit(see)` calls `see` with points whose convex hull holds the subtree.
template <typename Visit>
SubtreeShape fitContour(const Moments& moments, const Box& box, Visit&& visit) {
  SubtreeShape shape;
  shape.moments = moments;
  shape.box = box;
  const Anisotropy shapeAxes = anisotropy(moments);
  shape.contourClass = classify(shapeAxes);
  std::array<glm::dvec3, 3> axes{glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1)};
  glm::dvec3 low = box.min - moments.mean, high = box.max - moments.mean;
  if (shape.contourClass != ContourClass::volumetric) {
    axes = shapeAxes.axes;
    low = glm::dvec3(1e300);
    high = glm::dvec3(-1e300);
    visit([&](const glm::dvec3& point) {
      const glm::dvec3 d = point - moments.mean;
      const glm::dvec3 along(glm::dot(d, axes[0]), glm::dot(d, axes[1]), glm::dot(d, axes[2]));
      low = glm::min(low, along);
      high = glm::max(high, along);
    });
  }
  shape.centre = moments.mean;
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    shape.centre += axes[k] * (0.5 * (low[i] + high[i]));
    shape.halfAxes[k] = axes[k] * (0.5 * (high[i] - low[i]));
  }
  return shape;
}

}  // namespace strata
