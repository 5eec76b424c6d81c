#pragma once
#include <memory>
#include <string>

#include "io/scan/point_source.h"

namespace strata::synthetic {

/// Points of one part of a synthetic scan; every part but the last has as many.
inline constexpr std::size_t kPartPoints = 1'000'000;
inline constexpr double kMaxPoints = 1e11;
/// Positions lie on this grid, metres.
inline constexpr double kStep = 0.001;

/// `synthetic:NAME?points=1e9&seed=1`, with NAME one of plane, room, city, terrain, stack, sphere, degenerate, points
/// from 1 to kMaxPoints (1e6 where not given) and seed a whole number (1). Point i depends on the
/// specification alone, whatever part or thread makes it. Throws UsageError for anything else.
std::unique_ptr<PointSource> openScan(const std::string& spec);

}  // namespace strata::synthetic
