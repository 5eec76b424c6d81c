#include "core/view.h"

#include <algorithm>
#include <cmath>

namespace strata {

View wholePicture(const View& view) {
  if (view.tile == PictureTile{}) return view;
  View whole = view;
  whole.width = view.tile.pictureWidth;
  whole.height = view.tile.pictureHeight;
  whole.tile = {};
  return whole;
}

View tileOfPicture(const View& view, int left, int top, int width, int height) {
  const View whole = wholePicture(view);
  View tile = whole;
  tile.width = width;
  tile.height = height;
  tile.tile = {whole.width, whole.height, view.tile.left + left, view.tile.top + top};
  return tile;
}

ViewBasis viewBasis(const View& view) {
  glm::dvec3 forward = view.target - view.eye;
  const double length = glm::length(forward);
  forward = length > 0.0 && std::isfinite(length) ? forward / length : glm::dvec3(0.0, 1.0, 0.0);
  glm::dvec3 right = glm::cross(forward, view.up);
  if (!(glm::length(right) > 1e-9 * glm::length(view.up)))
    right = glm::cross(forward, std::abs(forward.z) < 0.9 ? glm::dvec3(0.0, 0.0, 1.0) : glm::dvec3(0.0, 1.0, 0.0));
  right = glm::normalize(right);
  return {right, glm::cross(right, forward), forward};
}

Projection projection(const View& view) {
  const ViewBasis basis = viewBasis(view);
  const View whole = wholePicture(view);
  const double halfWidth = 0.5 * whole.width - view.tile.left;  // from the image's corner to the view's axis
  const double halfHeight = 0.5 * whole.height - view.tile.top;
  Projection p;
  p.eye = view.eye;
  p.rowDepth = glm::dvec4(basis.forward, 0.0);
  if (view.orthographic) {
    const double scale = whole.height / view.orthographicHeight;
    p.rowX = glm::dvec4(basis.right * scale, halfWidth);
    p.rowY = glm::dvec4(-basis.up * scale, halfHeight);
    p.rowW = glm::dvec4(0.0, 0.0, 0.0, 1.0);
  } else {
    const double focal = 0.5 * whole.height / std::tan(0.5 * view.fovY);  // pixels
    p.rowX = glm::dvec4(basis.right * focal + basis.forward * halfWidth, 0.0);
    p.rowY = glm::dvec4(-basis.up * focal + basis.forward * halfHeight, 0.0);
    p.rowW = p.rowDepth;
  }
  return p;
}

std::array<glm::dvec4, 5> frustumPlanes(const View& view) {
  const Projection p = projection(view);
  const double width = view.width;
  const double height = view.height;
  std::array<glm::dvec4, 5> planes{p.rowX, p.rowW * width - p.rowX, p.rowY, p.rowW * height - p.rowY,
                                   p.rowDepth - glm::dvec4(0.0, 0.0, 0.0, view.nearPlane)};
  for (glm::dvec4& plane : planes) plane /= glm::length(glm::dvec3(plane));
  return planes;
}

bool boxInFrustum(const std::array<glm::dvec4, 5>& planes, const glm::dvec3& lo, const glm::dvec3& hi) {
  for (const glm::dvec4& plane : planes) {
    const glm::dvec3 farthest(plane.x >= 0 ? hi.x : lo.x, plane.y >= 0 ? hi.y : lo.y, plane.z >= 0 ? hi.z : lo.z);
    if (glm::dot(glm::dvec3(plane), farthest) + plane.w < 0.0) return false;
  }
  return true;
}

double pixelsAt(const View& view, double metres, double depth) {
  const int height = wholePicture(view).height;
  if (view.orthographic) return metres * height / view.orthographicHeight;
  return metres * 0.5 * height / (std::tan(0.5 * view.fovY) * std::max(depth, view.nearPlane));
}

View viewOfBox(const Box& box, const glm::dvec3& direction, int width, int height, double fovY) {
  View view;
  view.width = width;
  view.height = height;
  view.fovY = fovY;
  const double radius = std::max(0.5 * box.diagonal(), 1e-6);
  const double fovX = 2.0 * std::atan(std::tan(0.5 * fovY) * width / height);
  const double distance = radius / std::sin(0.5 * std::min(fovX, fovY));
  view.target = box.centre();
  view.eye = view.target - glm::normalize(direction) * distance;
  view.nearPlane = std::max(distance * 1e-5, 1e-6);
  return view;
}

}  // namespace strata
