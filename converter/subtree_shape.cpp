#include "converter/subtree_shape.h"

#include <utility>

namespace strata {
namespace {

/// The rows and columns of Moments::scatter.
constexpr std::array<std::pair<int, int>, 6> kPairs{{{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}}};

}  // namespace

void Moments::add(const glm::dvec3& point) {
  count += 1.0;
  const glm::dvec3 before = point - mean;
  mean += before / count;
  const glm::dvec3 after = point - mean;
  for (std::size_t k = 0; k < kPairs.size(); ++k) scatter[k] += before[kPairs[k].first] * after[kPairs[k].second];
}

void Moments::add(const Moments& other) {
  if (other.count == 0.0) return;
  const double total = count + other.count;
  const glm::dvec3 apart = other.mean - mean;
  const double weight = count * other.count / total;
  for (std::size_t k = 0; k < kPairs.size(); ++k)
    scatter[k] += other.scatter[k] + apart[kPairs[k].first] * apart[kPairs[k].second] * weight;
  mean += apart * (other.count / total);
  count = total;
}

std::array<glm::dvec3, 8> SubtreeShape::corners() const {
  std::array<glm::dvec3, 8> out;
  for (unsigned i = 0; i < 8; ++i)
    out[i] = centre + (i & 4 ? halfAxes[0] : -halfAxes[0]) + (i & 2 ? halfAxes[1] : -halfAxes[1]) +
             (i & 1 ? halfAxes[2] : -halfAxes[2]);
  return out;
}

}  // namespace strata
