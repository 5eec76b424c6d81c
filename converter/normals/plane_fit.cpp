#include "converter/normals/plane_fit.h"

#include <pcl/common/eigen.h>

namespace strata {
namespace {

constexpr double kLineShare = 1e-8;  // of the largest eigenvalue; points whose second one is below it lie on a line

}  // namespace

std::optional<glm::dvec3> planeNormal(std::span<const glm::dvec3> points) {
  if (points.size() < 3) return std::nullopt;
  // Relative to the first point, so that nothing is lost far from the origin.
  glm::dvec3 sum(0.0);
  double products[6] = {};  // xx xy xz yy yz zz
  for (const glm::dvec3& p : points) {
    const glm::dvec3 d = p - points.front();
    sum += d;
    products[0] += d.x * d.x;
    products[1] += d.x * d.y;
    products[2] += d.x * d.z;
    products[3] += d.y * d.y;
    products[4] += d.y * d.z;
    products[5] += d.z * d.z;
  }
  const double count = static_cast<double>(points.size());
  const glm::dvec3 mean = sum / count;
  Eigen::Matrix3d covariance;
  covariance(0, 0) = products[0] / count - mean.x * mean.x;
  covariance(0, 1) = covariance(1, 0) = products[1] / count - mean.x * mean.y;
  covariance(0, 2) = covariance(2, 0) = products[2] / count - mean.x * mean.z;
  covariance(1, 1) = products[3] / count - mean.y * mean.y;
  covariance(1, 2) = covariance(2, 1) = products[4] / count - mean.y * mean.z;
  covariance(2, 2) = products[5] / count - mean.z * mean.z;
  Eigen::Matrix3d vectors;
  Eigen::Vector3d values;
  pcl::eigen33(covariance, vectors, values);
  if (!(values(2) > 0.0) || !(values(1) > kLineShare * values(2))) return std::nullopt;
  const glm::dvec3 normal(vectors(0, 0), vectors(1, 0), vectors(2, 0));
  const double length = glm::length(normal);
  if (!(length > 0.0) || !std::isfinite(length)) return std::nullopt;
  return normal / length;
}

}  // namespace strata
