#pragma once
#include <vector>

#include <glm/glm.hpp>

#include "viewer/camera/scan_sample.h"

namespace strata {

/// Finds a walk of `stops` places from one end of the scan to the other along `axis`, `eyeHeight` metres above the
/// ground. It leads through cells with few obstacles at that height: it is the cheapest way over the grid (Dijkstra
/// 1959), smoothed. At least two of the places differ.
std::vector<glm::dvec3> findStreet(const ScanSample& scan, const HeightGrid& grid, const glm::dvec2& axis,
                                   double eyeHeight, int stops);

}  // namespace strata
