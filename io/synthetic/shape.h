#pragma once
#include <cstdint>
#include <memory>
#include <span>

#include <glm/glm.hpp>

#include "io/synthetic/asprs.h"

namespace strata::synthetic {

/// A point as a Shape makes it. The source rounds it to the grid, clamps it into the extent and packs it.
struct ShapePoint {
  glm::dvec3 position{0.0};            ///< metres, relative to the shape's origin
  glm::vec3 normal{0.0f, 0.0f, 1.0f};  ///< unit; stored when ShapeExtent::hasNormals
  glm::vec3 colour{0.0f};              ///< 0 to 1, as displayed
  float intensity = 0.0f;              ///< 0 to 1
  std::uint8_t classification = 1;     ///< ASPRS
};

/// The box that a shape fills.
struct ShapeExtent {
  glm::dvec3 origin{0.0};         ///< world
  glm::dvec3 min{0.0}, max{0.0};  ///< relative to `origin`
  bool hasNormals = false;
};

/// A distribution of points in which point i depends on the seed and on i alone. It never changes, so any thread may
/// use it.
class Shape {
 public:
  virtual ~Shape() = default;
  virtual const ShapeExtent& extent() const = 0;
  /// Makes the points `first`, `first` + 1, ... of the scan.
  virtual void generate(std::uint64_t first, std::span<ShapePoint> out) const = 0;
};

/// A square of 100 m x 100 m at z = 0, uniformly random.
std::unique_ptr<Shape> makePlane(std::uint64_t points, std::uint64_t seed);
/// The cuboid of planes of Günther et al. 2013, section 4 (see its class in shapes.cpp).
std::unique_ptr<Shape> makeStack(std::uint64_t points, std::uint64_t seed);
/// The surface of a sphere of 10 m radius, with normals.
std::unique_ptr<Shape> makeSphere(std::uint64_t points, std::uint64_t seed);
/// A mixture of copies of points, a line, a plane, a tiny cube and far outliers.
std::unique_ptr<Shape> makeDegenerate(std::uint64_t points, std::uint64_t seed);
/// Mountains with a lake and woods, scanned from the air in overlapping strips.
std::unique_ptr<Shape> makeTerrain(std::uint64_t points, std::uint64_t seed);

}  // namespace strata::synthetic
