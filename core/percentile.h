#pragma once
#include <span>

namespace strata {

/// The p-th percentile of the values, p from 0 to 100, linear between ranks (Hyndman and Fan 1996, type 7); 0 for no
/// values.
double percentile(std::span<const double> values, double p);

}  // namespace strata
