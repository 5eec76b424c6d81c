#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

#include "converter/subtree_shape.h"

namespace strata {

/// Points of one cell as local integers of 0 to 2^31 - 1, one array per axis: exact, and half the size of doubles.
struct LocalPoints {
  std::span<const std::int32_t> axis[3];
  glm::dvec3 step{1.0};  ///< metres between two integers, by axis

  std::size_t count() const { return axis[0].size(); }
};

/// The smallest and the largest integer of each axis.
struct LocalBounds {
  glm::ivec3 low{0}, high{0};
};
/// `points` has at least one point.
LocalBounds boundsOf(const LocalPoints& points);

/// Returns the moments in metres about the cell's lower corner. Groups of 512 points are summed in single precision
/// about the middle of `bounds`; the sums of the groups are added in double precision, always in the same order. Seven
/// digits are right.
Moments momentsOf(const LocalPoints& points, const LocalBounds& bounds);

}  // namespace strata
