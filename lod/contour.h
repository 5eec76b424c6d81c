#pragma once
#include <array>

#include <glm/glm.hpp>

#include "core/view.h"
#include "io/store/store.h"

namespace strata {

/// The oriented box around a node's own points, taken out of the packed record.
struct Contour {
  glm::dvec3 centre;               ///< world
  std::array<glm::dvec3, 3> axis;  ///< unit vectors; zero where the box has no extent
  std::array<double, 3> half;      ///< metres
};
Contour contourOf(const NodeRecord& record);

/// Distance of a point from the box in metres, 0 inside.
double distanceTo(const Contour& contour, const glm::dvec3& point);

/// A View in the form that testing many contours needs. Of a part of a picture the planes are the part's and all else
/// is the picture's, so that a node is drawn with as many points in each part that it reaches into.
struct ViewVolume {
  explicit ViewVolume(const View& view);

  std::array<glm::dvec4, 5> planes;  ///< frustumPlanes(): inwards, relative to the eye
  glm::dvec3 eye, forward;
  double nearPlane;        ///< metres
  double pixelsPerMetre;   ///< at 1 m in perspective, everywhere in an orthographic view
  double cosHalfDiagonal;  ///< of the angle between the view direction and the image's corners
  bool orthographic;
};

/// True when some of the contour, grown by `reach` metres on all sides, may be in view; never false for one that is.
/// Exact for each of the five planes: the box's extent along the plane's normal.
bool contourInView(const Contour& contour, double reach, const ViewVolume& volume);

/// The contour as it appears on the screen, at the point of it that is nearest to the eye.
struct ContourOnScreen {
  double pixelsPerMetre;  ///< at the nearest depth at which some of the contour may be visible
  double faceArea;        ///< square metres: of the silhouette, or of the largest face where that is more
  double facing;          ///< silhouette / largest face, at most 1: 1 seen face-on, near 0 for a flat box seen edge-on
  double extentPx;        ///< the longest side
};
ContourOnScreen projectContour(const Contour& contour, double reach, const ViewVolume& volume);

}  // namespace strata
