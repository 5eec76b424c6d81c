#pragma once
#include <array>
#include <cstdint>
#include <glm/glm.hpp>

#include "core/box.h"
#include "io/store/store.h"

namespace strata {

/// Count, mean and scatter matrix of points. They merge without losing digits (Chan, Golub and LeVeque 1983).
struct Moments {
  double count = 0.0;
  glm::dvec3 mean{0.0};
  std::array<double, 6> scatter{};  ///< sums of (xx, xy, xz, yy, yz, zz) about the mean

  void add(const glm::dvec3& point);
  void add(const Moments& other);
};

/// The part of a subtree that its ancestors need: the moments of its points, and the boxes around all of them.
/// Deviation from Kanzok 2015: a contour bounds the whole subtree, not only the node's own points, so that culling a
/// node may cull its children too (docs/decisions/0002-contours-bound-subtrees.md).
struct SubtreeShape {
  Moments moments;
  Box box;  ///< axis-aligned, world
  ContourClass contourClass = ContourClass::volumetric;
  glm::dvec3 centre{0.0};                ///< of the contour, world
  std::array<glm::dvec3, 3> halfAxes{};  ///< of the contour, orthogonal

  std::array<glm::dvec3, 8> corners() const;
};

}  // namespace strata
