#pragma once
#include <memory>
#include <string>

#include "io/scan/point_source.h"

namespace strata::synthetic {

/// Points of every part of a synthetic scan but the last.
inline constexpr std::size_t kPartPoints = 1'000'000;
inline constexpr double kMaxPoints = 1e11;
/// Positions lie on this grid, metres.
inline constexpr double kStep = 0.001;

/// Opens the scan that `spec` describes as `synthetic:NAME?points=1e9&seed=1`. NAME is plane, room, city, terrain,
/// stack, sphere or degenerate; `points` is from 1 to kMaxPoints (1e6 by default) and `seed` a whole number (1 by
/// default). Point i depends on `spec` and i alone, whichever part or thread makes it. Throws UsageError for any other
/// text.
std::unique_ptr<PointSource> openScan(const std::string& spec);

}  // namespace strata::synthetic
