#pragma once
#include <cstdint>
#include <vector>

#include "io/synthetic/random.h"
#include "io/synthetic/scene.h"

namespace strata::synthetic {

/// The size of a cone; `taper` is the radius at its top as a share of `radius` at its foot.
struct ConeSize {
  float radius, height, taper;
};

/// Collects the objects of a scene. Positions are metres; an `at` is the middle of the foot of an object.
class SceneBuilder {
 public:
  explicit SceneBuilder(std::uint64_t seed) : random(mix64(seed), 0) {}

  CounterRandom random;
  std::vector<Primitive> primitives;

  std::uint32_t newSeed() { return static_cast<std::uint32_t>(random.bits() >> 32); }
  Primitive& box(const glm::vec3& min, const glm::vec3& max, Material material, std::uint32_t seed = 0);
  /// A box given by its foot and its width, depth and height.
  Primitive& block(const glm::vec3& at, const glm::vec3& size, Material material, std::uint32_t seed = 0);
  Primitive& roof(const glm::vec3& min, const glm::vec3& max, const glm::vec2& slope, Material material,
                  std::uint32_t seed = 0);
  Primitive& cone(const glm::vec3& at, const ConeSize& size, Material material, std::uint32_t seed = 0);
  Primitive& ball(const glm::vec3& centre, const glm::vec3& radius, Material material, std::uint32_t seed = 0);
  Primitive& foliage(const glm::vec3& centre, const glm::vec3& radius, float meanFreePath, Material material,
                     std::uint32_t seed);
};

/// A roof over the rectangle of the walls, with slopes on two sides, or on all four for a hip.
struct PitchedRoof {
  glm::vec2 min, max;
  float eaves;  ///< height of the lower edge
  float slope;  ///< rise per metre
  bool ridgeAlongX;
  bool hip;
};
void addPitchedRoof(SceneBuilder& b, const PitchedRoof& roof, Material material, std::uint32_t seed);

// Street furniture and plants (street.cpp).
void addTree(SceneBuilder& b, const glm::vec3& at, float height);
void addConifer(SceneBuilder& b, const glm::vec3& at, float height);
void addLamp(SceneBuilder& b, const glm::vec3& at, const glm::vec2& armDirection);
void addCar(SceneBuilder& b, const glm::vec3& at, bool alongX);
void addBench(SceneBuilder& b, const glm::vec3& at, bool alongX);
void addStall(SceneBuilder& b, const glm::vec3& at);
void addFountain(SceneBuilder& b, const glm::vec3& at);

// Buildings (buildings.cpp).
/// The houses around one block with a yard inside; `min` and `max` are the outer walls.
void addPerimeterBlock(SceneBuilder& b, const glm::vec2& min, const glm::vec2& max);
void addVillas(SceneBuilder& b, const glm::vec2& min, const glm::vec2& max);
void addTowers(SceneBuilder& b, const glm::vec2& min, const glm::vec2& max);
/// A church with its nave along x; `at` is the middle of the nave's floor.
void addChurch(SceneBuilder& b, const glm::vec3& at);

}  // namespace strata::synthetic
