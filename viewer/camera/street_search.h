#pragma once
#include <vector>

#include <glm/glm.hpp>

#include "viewer/camera/scan_sample.h"

namespace strata {

/// A walk of `stops` places from one end of the scan to the other along `axis`, `eyeHeight` metres above the ground,
/// through cells with few obstacles at that height: the cheapest way over the grid (Dijkstra 1959), evened out.
/// At least two different places.
std::vector<glm::dvec3> findStreet(const ScanSample& scan, const HeightGrid& grid, const glm::dvec2& axis,
                                   double eyeHeight, int stops);

}  // namespace strata
