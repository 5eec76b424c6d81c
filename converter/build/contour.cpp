#include "converter/build/contour.h"

#include <Eigen/Eigenvalues>

namespace strata {
namespace {
constexpr double kClassThreshold = 0.03;  // Kanzok 2015, 3.1
constexpr std::array<std::pair<int, int>, 6> kPairs{{{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}}};
}  // namespace

Anisotropy anisotropy(const Moments& moments) {
  Anisotropy out;
  Eigen::Matrix3d matrix;
  for (std::size_t k = 0; k < kPairs.size(); ++k) {
    matrix(kPairs[k].first, kPairs[k].second) = moments.scatter[k];
    matrix(kPairs[k].second, kPairs[k].first) = moments.scatter[k];
  }
  const double scale = matrix.cwiseAbs().maxCoeff();
  if (!(scale > 0.0)) return out;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(matrix / scale);  // ascending eigenvalues
  const Eigen::Vector3d l = solver.eigenvalues().cwiseMax(0.0);
  const double sum = l.sum();
  if (!(sum > 0.0)) return out;
  out.linear = (l[2] - l[1]) / sum;
  out.planar = 2.0 * (l[1] - l[0]) / sum;
  out.spherical = 3.0 * l[0] / sum;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d v = solver.eigenvectors().col(2 - i);
    out.axes[static_cast<std::size_t>(i)] = glm::dvec3(v[0], v[1], v[2]);
  }
  out.axes[2] = glm::cross(out.axes[0], out.axes[1]);
  return out;
}

ContourClass classify(const Anisotropy& shape) {
  if (shape.spherical > kClassThreshold) return ContourClass::volumetric;
  if (shape.planar > kClassThreshold) return ContourClass::planar;
  return ContourClass::linear;
}

}  // namespace strata
