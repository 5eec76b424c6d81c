#pragma once
#include <glm/glm.hpp>
#include <limits>

namespace strata {

/// An axis-aligned box in world coordinates: metres, in the frame of the source. It is empty when min > max on an axis.
struct Box {
  glm::dvec3 min{std::numeric_limits<double>::infinity()};
  glm::dvec3 max{-std::numeric_limits<double>::infinity()};

  bool empty() const { return !(min.x <= max.x && min.y <= max.y && min.z <= max.z); }
  glm::dvec3 size() const { return empty() ? glm::dvec3(0.0) : max - min; }
  glm::dvec3 centre() const { return (min + max) * 0.5; }
  double diagonal() const { return glm::length(size()); }
  bool contains(const glm::dvec3& p) const {
    return glm::all(glm::lessThanEqual(min, p)) && glm::all(glm::lessThanEqual(p, max));
  }
  void add(const glm::dvec3& p) {
    min = glm::min(min, p);
    max = glm::max(max, p);
  }
  void add(const Box& other) {
    min = glm::min(min, other.min);
    max = glm::max(max, other.max);
  }

  bool operator==(const Box&) const = default;
};

}  // namespace strata
