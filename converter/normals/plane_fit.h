#pragma once
#include <glm/glm.hpp>
#include <optional>
#include <span>

namespace strata {

/// The direction, of unit length and either sign, across the plane nearest to the points: the eigenvector of the
/// smallest eigenvalue of their covariance, by PCL, as pcl::NormalEstimation does. Nothing where fewer than three
/// points or points on a line leave it open. The order of the points decides the last bits.
std::optional<glm::dvec3> planeNormal(std::span<const glm::dvec3> points);

}  // namespace strata
