#pragma once
#include <cstdint>
#include <limits>
#include <vector>

#include <glm/glm.hpp>

#include "io/synthetic/facade.h"
#include "io/synthetic/material.h"

namespace strata::synthetic {

enum class PrimitiveKind : std::uint8_t {
  box,
  roof,  ///< box under sloping planes: z <= min.z + slope * distance from the side, per axis with a slope
  cone,  ///< upright; its radius falls linearly to `taper` of it at the top (1 = cylinder, 0 = cone)
  ellipsoid,
  foliage,  ///< ellipsoid that stops a ray after a random way: the leaves of a crown
};

/// One object: the box around it in scene coordinates, metres, and the parameters of its kind.
struct Primitive {
  glm::vec3 min{0.0f}, max{0.0f};
  PrimitiveKind kind = PrimitiveKind::box;
  Material material = Material::plaster;
  std::uint8_t windowSides = 0;  ///< of boxes, see namespace side
  std::uint32_t seed = 0;        ///< picks colour and texture
  glm::vec2 slope{0.0f};         ///< of roofs: rise per metre from the sides across x and across y; 0 = gable
  float taper = 1.0f;            ///< of cones
  float meanFreePath = 1.0f;     ///< of foliage, metres
};

/// A ray of unit direction. Components of 0 are replaced by tiny ones; `seed` decides where foliage stops the ray.
struct Ray {
  Ray(const glm::vec3& rayOrigin, const glm::vec3& rayDirection, std::uint64_t raySeed);
  glm::vec3 origin, direction, inverse;
  std::uint64_t seed;
};

/// The nearest surface that a ray has met so far.
struct Hit {
  static constexpr int kGround = -1;

  float t = std::numeric_limits<float>::infinity();  ///< metres along the ray
  int primitive = kGround;
  glm::vec3 normal{0.0f, 0.0f, 1.0f};
};

/// Replaces `hit` when `ray` enters the primitive, which has this index, before hit.t. A ray that starts inside a solid
/// does not see it.
bool intersect(const Primitive& primitive, int index, const Ray& ray, Hit& hit);

/// Objects over a level ground at z = 0, which are found through a uniform grid of columns. It never changes.
class Scene {
 public:
  Scene(std::vector<Primitive> primitives, const glm::vec2& groundMin, const glm::vec2& groundMax, float cellSize);

  const std::vector<Primitive>& primitives() const { return primitives_; }
  glm::vec2 groundMin() const { return groundMin_; }
  glm::vec2 groundMax() const { return groundMax_; }
  /// Height of the highest object.
  float top() const { return top_; }
  /// Finds the first surface within `reach` metres; false when there is none.
  bool trace(const Ray& ray, float reach, Hit& hit) const;
  /// True when an object, the ground not counted, lies within `reach` metres.
  bool blocked(const Ray& ray, float reach) const;
  /// True when a ball does not touch the box of any primitive.
  bool isFree(const glm::vec3& centre, float radius) const;

 private:
  template <bool kAnyHit>
  bool walk(const Ray& ray, float reach, Hit& hit) const;

  std::vector<Primitive> primitives_;
  glm::vec2 groundMin_, groundMax_;
  float cellSize_;
  glm::ivec2 cells_;
  float top_ = 0.0f;
  std::vector<std::uint32_t> cellStart_;  ///< cells + 1 entries into cellItems_
  std::vector<std::uint32_t> cellItems_;
  std::vector<float> cellTop_;  ///< highest point of each column
};

}  // namespace strata::synthetic
