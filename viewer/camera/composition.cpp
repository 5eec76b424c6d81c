#include "viewer/camera/composition.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace strata {
namespace {

constexpr double kMargin = 0.97;  // share of the picture that a fitted view fills
constexpr int kColumns = 96;      // of the coarse depth picture
constexpr int kRows = 54;

}  // namespace

glm::dvec3 lookingAt(double azimuth, double elevation) {
  return {std::sin(azimuth) * std::cos(elevation), std::cos(azimuth) * std::cos(elevation), -std::sin(elevation)};
}

View fittedView(const ScanSample& scan, const glm::dvec3& direction, int width, int height, double fovY) {
  View view;
  view.width = width;
  view.height = height;
  view.fovY = fovY;
  view.eye = scan.bounds.centre();
  view.target = view.eye + direction;
  const ViewBasis basis = viewBasis(view);
  const double tanY = std::tan(0.5 * fovY) * kMargin;
  const double tanX = std::tan(0.5 * fovY) * width / height * kMargin;
  // In camera axes a point is inside when |x - ex| <= (z - ez) tan: each side bounds a sum of eye coordinates.
  constexpr double kLow = -std::numeric_limits<double>::infinity();
  double right = kLow, left = kLow, top = kLow, bottom = kLow;
  for (const glm::dvec3& p : scan.points) {
    const glm::dvec3 d = p - view.eye;
    const double x = glm::dot(d, basis.right);
    const double y = glm::dot(d, basis.up);
    const double z = glm::dot(d, basis.forward);
    right = std::max(right, x - z * tanX);
    left = std::max(left, -x - z * tanX);
    top = std::max(top, y - z * tanY);
    bottom = std::max(bottom, -y - z * tanY);
  }
  const double ez = std::min(-(right + left) / (2.0 * tanX), -(top + bottom) / (2.0 * tanY));
  const glm::dvec3 centre = view.eye;
  view.eye = centre + basis.right * (0.5 * (right - left)) + basis.up * (0.5 * (top - bottom)) + basis.forward * ez;
  view.target = view.eye + direction * std::max(glm::dot(centre - view.eye, basis.forward), 1e-6);
  return view;
}

Composition compose(const ScanSample& scan, const View& view, double subject) {
  View coarse = view;
  coarse.width = kColumns;
  coarse.height = kRows;
  const Projection p = projection(coarse);
  std::vector<double> depth(kColumns * kRows, std::numeric_limits<double>::infinity());
  double n = 0, sz = 0, sd = 0, szz = 0, sdd = 0, szd = 0;
  for (const glm::dvec3& point : scan.points) {
    const glm::dvec4 d(point - p.eye, 1.0);
    const double z = glm::dot(p.rowDepth, d);
    if (z <= view.nearPlane) continue;
    const double x = glm::dot(p.rowX, d) / z;
    const double y = glm::dot(p.rowY, d) / z;
    const double half = std::min(0.5 * pixelsAt(coarse, 1.5 * scan.spacing, z), 12.0);
    if (x + half < 0 || y + half < 0 || x - half >= kColumns || y - half >= kRows) continue;
    for (int v = std::max(0, static_cast<int>(y - half)); v <= std::min(kRows - 1, static_cast<int>(y + half)); ++v)
      for (int u = std::max(0, static_cast<int>(x - half)); u <= std::min(kColumns - 1, static_cast<int>(x + half));
           ++u)
        depth[static_cast<std::size_t>(v * kColumns + u)] =
            std::min(depth[static_cast<std::size_t>(v * kColumns + u)], z);
    const double height = point.z - scan.bounds.min.z;
    ++n, sz += height, sd += z, szz += height * height, sdd += z * z, szd += height * z;
  }
  Composition result;
  for (const double z : depth) {
    result.coverage += std::isfinite(z) ? 1.0 : 0.0;
    result.blocked += z < 0.5 * subject ? 1.0 : 0.0;
  }
  result.coverage /= kColumns * kRows;
  result.blocked /= kColumns * kRows;
  const double spread = std::sqrt(std::max(0.0, n * szz - sz * sz) * std::max(0.0, n * sdd - sd * sd));
  result.layering = spread > 1e-12 ? (n * szd - sz * sd) / spread : 0.0;
  return result;
}

}  // namespace strata
