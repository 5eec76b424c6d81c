#pragma once
#include <glm/glm.hpp>
#include <optional>
#include <span>

namespace strata {

/// Returns the normal, of unit length and either sign, of the plane nearest to the points: the eigenvector of the
/// smallest eigenvalue of their covariance, by PCL, as pcl::NormalEstimation computes it. Returns nothing for fewer
/// than three points and for points on a line. The order of the points decides the last bits.
std::optional<glm::dvec3> planeNormal(std::span<const glm::dvec3> points);

}  // namespace strata
