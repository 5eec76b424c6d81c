#pragma once
#include <array>
#include <cstdint>

#include "core/box.h"
#include "io/store/store.h"

namespace strata {

/// Count, mean and scatter matrix of points; merges without losing digits (Chan, Golub and LeVeque 1983).
struct Moments {
  double count = 0.0;
  glm::dvec3 mean{0.0};
  std::array<double, 6> scatter{};  ///< sums of (xx, xy, xz, yy, yz, zz) about the mean

  void add(const glm::dvec3& point);
  void add(const Moments& other);
};

/// c_l, c_p, c_s of Kanzok 2015, eq. 1, and the principal axes, longest first.
struct Anisotropy {
  double linear = 0.0, planar = 0.0, spherical = 1.0;
  std::array<glm::dvec3, 3> axes{glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1)};
};
Anisotropy anisotropy(const Moments& moments);

/// Kanzok 2015, 3.1: volumetric where c_s > 0.03, else planar where c_p > 0.03, else linear.
ContourClass classify(const Anisotropy& anisotropy);

/// What an ancestor has to know of a subtree: its points' moments and the box around all of them.
/// Deviation from Kanzok: a contour bounds the whole subtree, not only the node's own points, so that culling a node
/// may cull its children (docs/decisions/0002-contours-bound-subtrees.md).
struct SubtreeShape {
  Moments moments;
  Box box;  ///< axis-aligned, world
  ContourClass contourClass = ContourClass::volumetric;
  glm::dvec3 centre{0.0};                ///< of the contour
  std::array<glm::dvec3, 3> halfAxes{};  ///< orthogonal

  std::array<glm::dvec3, 8> corners() const;
};

/// The shape of a node: `moments` and `box` are of the whole subtree already; `visit` calls its argument for points
/// whose convex hull holds the subtree.
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
