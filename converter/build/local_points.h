#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

#include "converter/build/contour.h"

namespace strata {

/// Points of one cube as integers of 0 to 2^31 - 1, one array an axis: exact, and half the size of doubles.
struct LocalPoints {
  std::span<const std::int32_t> axis[3];
  glm::dvec3 step{1.0};  ///< metres an integer stands for, by axis

  std::size_t count() const { return axis[0].size(); }
};

/// Smallest and largest integer of each axis; `points` has at least one point.
struct LocalBounds {
  glm::ivec3 low{0}, high{0};
};
LocalBounds boundsOf(const LocalPoints& points);

/// Moments in metres about the cube's lower corner. Sums of 512 points are single precision about the middle of
/// `bounds`, the sums of those double: seven digits, always in the same order.
Moments momentsOf(const LocalPoints& points, const LocalBounds& bounds);

}  // namespace strata
