#pragma once
#include "core/box.h"

namespace strata {

/// The grid step for coordinates whose file states none. Each is a power of ten.

/// At most half a unit in the last place of a float32 as large as `largest`; 0 when `largest` is 0.
double float32Step(double largest);
/// For float64, most digits of which carry no information: at most 1e-9 of the longest side of `bounds` (of the largest
/// coordinate when that side is 0) and at least 1e-9 metres. 0 when all coordinates are 0.
double float64Step(const Box& bounds);

/// Replaces steps of 0, on axes whose coordinates are all 0, by the coarsest of the others, or 0.001 when all are 0.
glm::dvec3 fillSteps(glm::dvec3 step);

}  // namespace strata
