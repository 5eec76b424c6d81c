#include "lod/contour.h"

#include <algorithm>
#include <cmath>

namespace strata {

Contour contourOf(const NodeRecord& record) {
  Contour contour;
  contour.centre = {record.centre[0], record.centre[1], record.centre[2]};
  for (std::size_t a = 0; a < 3; ++a) {
    const glm::dvec3 halfAxis(record.halfAxis[a][0], record.halfAxis[a][1], record.halfAxis[a][2]);
    const double length = glm::length(halfAxis);
    contour.half[a] = length;
    contour.axis[a] = length > 0.0 ? halfAxis / length : glm::dvec3(0.0);
  }
  return contour;
}

namespace {

/// The absolute coordinates of a point in the box's frame. A flat box has one axis that is zero; the point's distance
/// along it is what the other axes leave of its length.
std::array<double, 3> offsetInBox(const Contour& contour, const glm::dvec3& relative) {
  std::array<double, 3> offset;
  double rest = glm::dot(relative, relative);
  std::size_t flat = 3;
  for (std::size_t a = 0; a < 3; ++a) {
    const double along = glm::dot(relative, contour.axis[a]);
    offset[a] = std::abs(along);
    rest -= along * along;
    if (contour.half[a] == 0.0) flat = a;
  }
  if (flat < 3) offset[flat] = std::sqrt(std::max(rest, 0.0));
  return offset;
}

double distanceOutside(const Contour& contour, const std::array<double, 3>& offset) {
  double squared = 0.0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double outside = std::max(offset[a] - contour.half[a], 0.0);
    squared += outside * outside;
  }
  return std::sqrt(squared);
}

/// Half the contour's extent along a direction.
double extentAlong(const Contour& contour, const glm::dvec3& direction) {
  double extent = 0.0;
  for (std::size_t a = 0; a < 3; ++a) extent += contour.half[a] * std::abs(glm::dot(direction, contour.axis[a]));
  return extent;
}

}  // namespace

double distanceTo(const Contour& contour, const glm::dvec3& point) {
  return distanceOutside(contour, offsetInBox(contour, point - contour.centre));
}

ViewVolume::ViewVolume(const View& view)
    : planes(frustumPlanes(view)),
      eye(view.eye),
      forward(viewBasis(view).forward),
      nearPlane(view.nearPlane),
      pixelsPerMetre(0.0),
      cosHalfDiagonal(1.0),
      orthographic(view.orthographic) {
  const View whole = wholePicture(view);
  if (orthographic) {
    pixelsPerMetre = whole.height / view.orthographicHeight;
    return;
  }
  const double tanY = std::tan(0.5 * view.fovY);
  const double tanX = tanY * whole.width / whole.height;
  pixelsPerMetre = 0.5 * whole.height / tanY;
  cosHalfDiagonal = 1.0 / std::sqrt(1.0 + tanX * tanX + tanY * tanY);
}

bool contourInView(const Contour& contour, double reach, const ViewVolume& volume) {
  const glm::dvec3 relative = contour.centre - volume.eye;
  // A box that touches a plane must not be lost to rounding.
  const double slack = reach + 1e-12 * (std::abs(relative.x) + std::abs(relative.y) + std::abs(relative.z));
  for (const glm::dvec4& plane : volume.planes) {
    const glm::dvec3 normal(plane);
    if (glm::dot(normal, relative) + plane.w + slack + extentAlong(contour, normal) < 0.0) return false;
  }
  return true;
}

ContourOnScreen projectContour(const Contour& contour, double reach, const ViewVolume& volume) {
  const glm::dvec3 relative = contour.centre - volume.eye;
  const std::array<double, 3> offset = offsetInBox(contour, relative);
  const double distance = std::max(distanceOutside(contour, offset) - reach, volume.nearPlane);

  ContourOnScreen screen;
  screen.pixelsPerMetre = volume.pixelsPerMetre;
  if (!volume.orthographic) {
    // Two lower bounds of the depth of a visible point: the least depth of the box, and the depth at the picture's
    // corner of a point at this distance. The second helps with long boxes that pass beside or below the eye.
    const double ownDepth = glm::dot(relative, volume.forward) - extentAlong(contour, volume.forward) - reach;
    screen.pixelsPerMetre /= std::max({ownDepth, distance * volume.cosHalfDiagonal, volume.nearPlane});
  }

  double silhouette = 0.0;
  double largestFace = 0.0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double face = 4.0 * contour.half[(a + 1) % 3] * contour.half[(a + 2) % 3];
    const double cosine = volume.orthographic
                              ? (contour.half[a] > 0.0 ? std::abs(glm::dot(volume.forward, contour.axis[a])) : 1.0)
                              : std::min((offset[a] + contour.half[a] + reach) / distance, 1.0);
    silhouette += face * cosine;
    largestFace = std::max(largestFace, face);
  }
  screen.faceArea = std::max(silhouette, largestFace);
  screen.facing = largestFace > 0.0 ? std::min(silhouette / largestFace, 1.0) : 1.0;
  screen.extentPx =
      2.0 * (std::max({contour.half[0], contour.half[1], contour.half[2]}) + reach) * screen.pixelsPerMetre;
  return screen;
}

}  // namespace strata
