#pragma once
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "core/picture.h"
#include "core/view.h"
#include "viewer/camera/scan_sample.h"

namespace strata {

/// A place worth a picture.
struct Still {
  std::string name;  ///< "overview", "close", "detail"
  View view;
  double subject = 0.0;  ///< metres from the eye to what is shown
};

/// Unit vector from the eye towards the scene for a compass direction (0 = looking north) and a height over the
/// horizon, both in radians.
glm::dvec3 lookingAt(double azimuth, double elevation);

/// The nearest view in `direction` that still holds every point of the scene, with a small margin.
View fittedView(const Scene& scene, const glm::dvec3& direction, int width, int height, double fovY);

/// How a view would look, from a coarse depth picture of the scene's sample.
struct Composition {
  double coverage = 0.0;  ///< share of the picture with something in it
  double blocked = 0.0;   ///< share covered by things nearer than half the subject's distance
  double layering = 0.0;  ///< correlation of height with depth, -1 to 1: positive = tall things stand behind low ones
};
Composition compose(const Scene& scene, const View& view, double subject);

/// All of the scan from a pleasant direction; of a room, from an upper corner inside.
Still overviewStill(const Scene& scene, int width, int height);
/// A densely scanned part with much structure fills the picture.
Still closeStill(const Scene& scene, const Store& store, int width, int height);
/// A surface in that part, so near that single points can be told apart.
Still detailStill(const Scene& scene, const Store& store, const Still& close, int width, int height);

std::vector<Still> chooseStills(const Scene& scene, const Store& store, int width, int height);

/// Distance between neighbouring points of the nearest surface.
struct FrontSpacing {
  double pixels = 0.0;  ///< in all but the sparsest third of the picture
  double metres = 0.0;  ///< in the nearer half of the picture, all but the sparsest third of it
};
/// `frame` is drawn from `view` with points of one pixel.
FrontSpacing frontSpacing(const Picture& frame, const View& view);
/// Side of the squares that close the gaps.
int closedPointSize(double spacingPx);
/// The same in metres.
float closedPointMetres(double spacing);
/// The same from `factor` times as far away.
Still fartherStill(const Still& still, double factor);

}  // namespace strata
