#pragma once
#include "viewer/camera/scan_sample.h"

namespace strata {

/// A piece of surface that was scanned densely all around.
struct DensePlace {
  glm::dvec3 centre{0.0};
  double spacing = 0.0;  ///< metres between neighbouring points there
};

inline constexpr std::uint64_t kMostRead = 4'000'000;
/// Reads the nodes that reach into the ball around `centre` and finds the place in it with the most evenly dense
/// surface. A ball whose nodes hold more than kMostRead points is made smaller first. Throws Error for damaged nodes.
DensePlace densePlace(const Store& store, const glm::dvec3& centre, double radius);

/// Finds such a place among given points. `resolution` is the edge of the cells whose points are counted.
DensePlace densestAmong(const std::vector<glm::dvec3>& points, double resolution);

}  // namespace strata
