#include "io/table/coordinate_step.h"

#include <algorithm>
#include <cmath>

namespace strata {
namespace {

double powerOfTenAtMost(double value) { return std::pow(10.0, std::floor(std::log10(value))); }

}  // namespace

double float32Step(double largest) {
  if (!(largest > 0.0)) return 0.0;
  const double ulp = std::ldexp(1.0, std::max(std::ilogb(largest), -126) - 23);
  return powerOfTenAtMost(ulp * 0.5);
}

double float64Step(const Box& bounds) {
  if (bounds.empty()) return 0.0;
  const glm::dvec3 size = bounds.size();
  const glm::dvec3 reach = glm::max(glm::abs(bounds.min), glm::abs(bounds.max));
  double length = std::max({size.x, size.y, size.z});
  if (length <= 0.0) length = std::max({reach.x, reach.y, reach.z});
  if (!(length > 0.0)) return 0.0;
  // A length that is a power of ten itself must not fall below it by rounding.
  return std::max(1e-9, powerOfTenAtMost(length * 1e-9 * (1.0 + 1e-12)));
}

glm::dvec3 fillSteps(glm::dvec3 step) {
  double coarsest = std::max({step.x, step.y, step.z});
  if (coarsest <= 0.0) coarsest = 0.001;
  for (int axis = 0; axis < 3; ++axis)
    if (step[axis] <= 0.0) step[axis] = coarsest;
  return step;
}

}  // namespace strata
