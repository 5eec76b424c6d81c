#pragma once
#include <glm/glm.hpp>

#include "core/view.h"
#include "viewer/camera/scan_sample.h"

namespace strata {

/// The unit vector from the eye towards the scan. `azimuth` is the compass direction, 0 to the north, and `elevation`
/// the height of the eye over the horizon, both in radians.
glm::dvec3 lookingAt(double azimuth, double elevation);

/// The nearest view in `direction` that still holds every point of the sample, with a small margin.
View fittedView(const ScanSample& scan, const glm::dvec3& direction, int width, int height, double fovY);

/// Tells how a view would look, judged by a coarse depth picture of the sample.
struct Composition {
  double coverage = 0.0;  ///< share of the picture with something in it
  double blocked = 0.0;   ///< share covered by things nearer than half the subject's distance
  double layering = 0.0;  ///< correlation of height with depth, -1 to 1: positive = tall things are behind low ones
};
/// `subject` is the distance in metres from the eye to what the view is to show.
Composition compose(const ScanSample& scan, const View& view, double subject);

}  // namespace strata
