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

/// Shows all of the scan from a pleasant direction, or a room from one of its upper corners.
Still overviewStill(const ScanSample& scan, int width, int height);
/// Shows a densely scanned part with much structure, which fills the picture.
Still closeStill(const ScanSample& scan, const Store& store, int width, int height);
/// Shows a surface in the part that `close` shows, so near that single points can be told apart.
Still detailStill(const ScanSample& scan, const Store& store, const Still& close, int width, int height);

/// The overview, the close still and the detail, in this order.
std::vector<Still> chooseStills(const ScanSample& scan, const Store& store, int width, int height);

/// The distance between neighbouring points of the nearest surface; the sparsest third of the picture does not count.
struct FrontSpacing {
  double pixels = 0.0;
  double metres = 0.0;  ///< in the nearer half of the picture
};
/// Measures a picture that was drawn from `view` with points of one pixel.
FrontSpacing frontSpacing(const Picture& picture, const View& view);
/// The side in pixels of square points that close gaps of `spacingPx` pixels.
int closedPointSize(double spacingPx);
/// The side in metres of square points that close gaps of `spacing` metres.
float closedPointMetres(double spacing);
/// The same still from `factor` times as far away.
Still fartherStill(const Still& still, double factor);

}  // namespace strata
