#pragma once
#include <array>

#include <glm/glm.hpp>

#include "core/view.h"
#include "io/store/store.h"

namespace strata {

/// The oriented box around a node's own points, as doubles.
struct Contour {
  glm::dvec3 centre;               ///< world coordinates
  std::array<glm::dvec3, 3> axis;  ///< unit vectors; zero along which the box has no extent
  std::array<double, 3> half;      ///< metres
};
Contour contourOf(const NodeRecord& record);

/// The distance of a point from the box in metres; 0 inside.
double distanceTo(const Contour& contour, const glm::dvec3& point);

/// A View in the form that testing many contours needs. For a tile the planes are the tile's and everything else is the
/// whole picture's, so that a node gets the same number of points in every tile that it reaches into.
struct ViewVolume {
  explicit ViewVolume(const View& view);

  std::array<glm::dvec4, 5> planes;  ///< frustumPlanes(): inwards, relative to the eye
  glm::dvec3 eye, forward;
  double nearPlane;        ///< metres
  double pixelsPerMetre;   ///< at 1 m in perspective, everywhere in an orthographic view
  double cosHalfDiagonal;  ///< cosine of the angle between the view direction and the picture's corners
  bool orthographic;
};

/// False only when the contour, grown by `reach` metres on all sides, is out of view. The test is exact for each of the
/// five planes: it takes the box's extent along the plane's normal.
bool contourInView(const Contour& contour, double reach, const ViewVolume& volume);

/// The contour as it appears on the screen at its point nearest to the eye.
struct ContourOnScreen {
  double pixelsPerMetre;  ///< at the least depth at which a part of the contour may be visible
  double faceArea;        ///< square metres of the silhouette or of the largest face, whichever is more
  double facing;          ///< silhouette / largest face, at most 1: 1 seen face-on, near 0 for a flat box seen edge-on
  double extentPx;        ///< length of the longest side
};
ContourOnScreen projectContour(const Contour& contour, double reach, const ViewVolume& volume);

}  // namespace strata
