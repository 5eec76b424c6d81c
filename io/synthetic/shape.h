#pragma once
#include <cstdint>
#include <memory>
#include <span>

#include <glm/glm.hpp>

namespace strata::synthetic {

/// What the generators of a synthetic scan make; the source rounds, clamps and packs it.
struct ShapePoint {
  glm::dvec3 position{0.0};            ///< metres, relative to the shape's origin
  glm::vec3 normal{0.0f, 0.0f, 1.0f};  ///< unit; stored only where the shape says so
  glm::vec3 colour{0.0f};              ///< 0 to 1, as displayed
  float intensity = 0.0f;              ///< 0 to 1
  std::uint8_t classification = 1;     ///< ASPRS
};

/// ASPRS classes that the generators use.
namespace asprs {
inline constexpr std::uint8_t kUnclassified = 1, kGround = 2, kLowVegetation = 3, kHighVegetation = 5, kBuilding = 6,
                              kWater = 9, kRoad = 11;
}  // namespace asprs

struct ShapeExtent {
  glm::dvec3 origin{0.0};         ///< world
  glm::dvec3 min{0.0}, max{0.0};  ///< relative to origin; the source clamps points into it
  bool hasNormals = false;
};

/// A distribution of points in which point i depends on the seed and on i alone. Immutable, so any thread may ask.
class Shape {
 public:
  virtual ~Shape() = default;
  virtual const ShapeExtent& frame() const = 0;
  /// Points `first`, `first` + 1, ...; the range lies within the scan's count.
  virtual void generate(std::uint64_t first, std::span<ShapePoint> out) const = 0;
};

/// 100 m x 100 m at z = 0, uniformly random.
std::unique_ptr<Shape> makePlane(std::uint64_t points, std::uint64_t seed);
/// The cuboid of planes of Günther et al. 2013, section 4 (see the class in synthetic_shapes.cpp).
std::unique_ptr<Shape> makeStack(std::uint64_t points, std::uint64_t seed);
/// Surface of a sphere of 10 m radius, with normals.
std::unique_ptr<Shape> makeSphere(std::uint64_t points, std::uint64_t seed);
/// Copies, a line, a plane, a tiny cube and far outliers, mixed.
std::unique_ptr<Shape> makeDegenerate(std::uint64_t points, std::uint64_t seed);
/// Mountains with a lake and woods, scanned from the air in overlapping strips.
std::unique_ptr<Shape> makeTerrain(std::uint64_t points, std::uint64_t seed);

}  // namespace strata::synthetic
