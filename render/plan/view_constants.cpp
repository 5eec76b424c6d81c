#include "render/plan/view_constants.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace strata {
namespace {

bool finite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

}  // namespace

ViewConstants viewConstants(const View& view) {
  ViewConstants c;
  c.view = view;
  c.projection = projection(view);
  c.planes = frustumPlanes(view);
  const View whole = wholePicture(view);
  const Projection p = projection(whole);
  c.rowX = p.rowX - p.rowW * (0.5 * whole.width);
  c.rowY = p.rowY - p.rowW * (0.5 * whole.height);
  c.pixelsPerMetre = glm::length(glm::dvec3(c.rowY));
  if (!view.orthographic && c.pixelsPerMetre > 0.0) {
    const double halfDiagonal = 0.5 * std::hypot(whole.width, whole.height);
    c.cornerStretch = std::hypot(1.0, halfDiagonal / c.pixelsPerMetre);
  }
  c.drawable = view.width > 0 && view.height > 0 && finite(view.eye) && finite(c.rowX) && finite(c.rowY) &&
               finite(c.projection.rowDepth) && std::isfinite(view.nearPlane);
  return c;
}

Viewport viewport(const ViewConstants& c) {
  Viewport v;
  v.width = static_cast<float>(c.view.width);
  v.height = static_cast<float>(c.view.height);
  const View whole = wholePicture(c.view);
  v.halfWidth = 0.5f * static_cast<float>(whole.width);
  v.halfHeight = 0.5f * static_cast<float>(whole.height);
  v.left = static_cast<float>(c.view.tile.left);
  v.top = static_cast<float>(c.view.tile.top);
  v.nearDepth = std::max(static_cast<float>(c.view.nearPlane), std::numeric_limits<float>::min());
  v.perspective = !c.view.orthographic;
  return v;
}

}  // namespace strata
