#include <algorithm>
#include <cmath>

#include "io/synthetic/random.h"
#include "io/synthetic/scene_builder.h"

namespace strata::synthetic {

Primitive& SceneBuilder::box(const glm::vec3& min, const glm::vec3& max, Material material, std::uint32_t seed) {
  Primitive p;
  p.min = min;
  p.max = max;
  p.material = material;
  p.seed = seed;
  return primitives.emplace_back(p);
}

Primitive& SceneBuilder::block(const glm::vec3& at, const glm::vec3& size, Material material, std::uint32_t seed) {
  return box({at.x - size.x * 0.5f, at.y - size.y * 0.5f, at.z},
             {at.x + size.x * 0.5f, at.y + size.y * 0.5f, at.z + size.z}, material, seed);
}

Primitive& SceneBuilder::roof(const glm::vec3& min, const glm::vec3& max, const glm::vec2& slope, Material material,
                              std::uint32_t seed) {
  Primitive& p = box(min, max, material, seed);
  p.kind = PrimitiveKind::roof;
  p.slope = slope;
  return p;
}

Primitive& SceneBuilder::cone(const glm::vec3& at, const ConeSize& size, Material material, std::uint32_t seed) {
  const auto& [radius, height, taper] = size;
  Primitive& p = block(at, {2.0f * radius, 2.0f * radius, height}, material, seed);
  p.kind = PrimitiveKind::cone;
  p.taper = taper;
  return p;
}

Primitive& SceneBuilder::ball(const glm::vec3& centre, const glm::vec3& radius, Material material, std::uint32_t seed) {
  Primitive& p = box(centre - radius, centre + radius, material, seed);
  p.kind = PrimitiveKind::ellipsoid;
  return p;
}

Primitive& SceneBuilder::foliage(const glm::vec3& centre, const glm::vec3& radius, float meanFreePath,
                                 Material material, std::uint32_t seed) {
  Primitive& p = ball(centre, radius, material, seed);
  p.kind = PrimitiveKind::foliage;
  p.meanFreePath = meanFreePath;
  return p;
}

void addTree(SceneBuilder& b, const glm::vec3& at, float height) {
  const std::uint32_t seed = b.newSeed();
  b.cone(at, {0.05f + 0.018f * height, height * 0.6f, 0.55f}, Material::bark, seed);
  const float spread = height * 0.22f;
  for (int i = 0; i < 6; ++i) {  // clumps of leaves around the top of the trunk
    const float angle = static_cast<float>(i) * 1.2566f + b.random.between(-0.4f, 0.4f);
    const float out = i == 5 ? 0.0f : spread * b.random.between(0.7f, 1.05f);
    const float z = at.z + height * (i == 5 ? 0.80f : b.random.between(0.50f, 0.72f));
    const float radius = spread * b.random.between(0.75f, 1.0f);
    b.foliage({at.x + out * std::cos(angle), at.y + out * std::sin(angle), z}, {radius, radius, radius * 0.85f},
              0.05f * height, Material::leaf, seed);
  }
}

void addConifer(SceneBuilder& b, const glm::vec3& at, float height) {
  const std::uint32_t seed = b.newSeed();
  b.cone(at, {0.03f * height, height * 0.9f, 0.2f}, Material::bark, seed);
  for (int i = 0; i < 7; ++i) {  // whorls
    const float level = 0.18f + 0.12f * static_cast<float>(i),
                radius = height * (0.25f - 0.033f * static_cast<float>(i));
    b.foliage({at.x, at.y, at.z + height * level}, {radius, radius, height * 0.10f}, 0.035f * height, Material::leaf,
              seed);
  }
}

void addLamp(SceneBuilder& b, const glm::vec3& at, const glm::vec2& armDirection) {
  b.cone(at, {0.16f, 0.9f, 0.6f}, Material::metal);
  b.cone({at.x, at.y, at.z + 0.9f}, {0.07f, 5.1f, 0.8f}, Material::metal);
  const glm::vec2 tip = glm::vec2(at.x, at.y) + armDirection * 1.3f;
  const glm::vec2 low = glm::min(tip, glm::vec2(at.x, at.y)) - 0.04f,
                  high = glm::max(tip, glm::vec2(at.x, at.y)) + 0.04f;
  b.box({low.x, low.y, at.z + 5.92f}, {high.x, high.y, at.z + 6.0f}, Material::metal);
  b.block({tip.x, tip.y, at.z + 5.8f}, {0.36f, 0.36f, 0.12f}, Material::metal);
  b.ball({tip.x, tip.y, at.z + 5.75f}, {0.2f, 0.2f, 0.16f}, Material::lamp);
}

void addCar(SceneBuilder& b, const glm::vec3& at, bool alongX) {
  const std::uint32_t seed = b.newSeed();
  const float length = b.random.between(3.9f, 4.6f), height = b.random.between(0.0f, 0.25f);
  const auto oriented = [&](float along, float across, float z) {
    return alongX ? glm::vec3(along, across, z) : glm::vec3(across, along, z);
  };
  const auto place = [&](float along, float across, float z) { return at + oriented(along, across, z); };
  const glm::vec3 half = oriented(length * 0.5f, 0.88f, 0.0f);
  const glm::vec2 bodySlope = alongX ? glm::vec2(3.0f, 6.0f) : glm::vec2(6.0f, 3.0f);
  b.roof(at - half + glm::vec3(0.0f, 0.0f, 0.22f), at + half + glm::vec3(0.0f, 0.0f, 0.82f + height), bodySlope,
         Material::paint, seed);
  const glm::vec3 cabin = oriented(length * 0.31f, 0.80f, 0.0f), back = oriented(-0.15f, 0.0f, 0.0f);
  const glm::vec2 cabinSlope = alongX ? glm::vec2(1.1f, 3.5f) : glm::vec2(3.5f, 1.1f);
  b.roof(at + back - cabin + glm::vec3(0.0f, 0.0f, 0.80f + height),
         at + back + cabin + glm::vec3(0.0f, 0.0f, 1.36f + height), cabinSlope, Material::glass, seed);
  const glm::vec3 lid = oriented(length * 0.18f, 0.62f, 0.0f);
  b.box(at + back - lid + glm::vec3(0.0f, 0.0f, 1.34f + height),
        at + back + lid + glm::vec3(0.0f, 0.0f, 1.42f + height), Material::paint, seed);
  for (const float along : {-0.31f, 0.31f}) {
    for (const float across : {-0.78f, 0.78f}) {
      const glm::vec3 wheel = place(along * length, across, 0.32f), radius = oriented(0.32f, 0.13f, 0.32f);
      b.ball(wheel, {radius.x, radius.y, 0.32f}, Material::rubber);
    }
  }
  for (const float across : {-0.6f, 0.6f})
    b.block(place(length * 0.49f, across, 0.55f), glm::abs(oriented(0.12f, 0.3f, 0.0f)) + glm::vec3(0.0f, 0.0f, 0.14f),
            Material::lamp);
}

void addBench(SceneBuilder& b, const glm::vec3& at, bool alongX) {
  const glm::vec3 seat = alongX ? glm::vec3(1.8f, 0.45f, 0.06f) : glm::vec3(0.45f, 1.8f, 0.06f);
  b.block(at + glm::vec3(0.0f, 0.0f, 0.42f), seat, Material::wood);
  const glm::vec3 shift = alongX ? glm::vec3(0.0f, 0.24f, 0.5f) : glm::vec3(0.24f, 0.0f, 0.5f);
  b.block(at + shift, alongX ? glm::vec3(1.8f, 0.05f, 0.4f) : glm::vec3(0.05f, 1.8f, 0.4f), Material::wood);
  for (const float end : {-0.75f, 0.75f}) {
    b.block(at + (alongX ? glm::vec3(end, 0.0f, 0.0f) : glm::vec3(0.0f, end, 0.0f)), {0.08f, 0.4f, 0.42f},
            Material::metal);
  }
}

void addStall(SceneBuilder& b, const glm::vec3& at) {
  const std::uint32_t seed = b.newSeed();
  b.block(at + glm::vec3(0.0f, 0.0f, 0.75f), {2.6f, 1.2f, 0.12f}, Material::wood, seed);
  for (const glm::vec2& post :
       {glm::vec2(-1.3f, -0.9f), glm::vec2(1.3f, -0.9f), glm::vec2(-1.3f, 0.9f), glm::vec2(1.3f, 0.9f)}) {
    b.block(at + glm::vec3(post.x, post.y, 0.0f), {0.07f, 0.07f, 2.3f}, Material::wood, seed);
  }
  for (int i = 0; i < 6; ++i) {  // goods
    b.block(at + glm::vec3(-1.05f + 0.42f * static_cast<float>(i), b.random.between(-0.25f, 0.25f), 0.87f),
            {0.36f, 0.5f, b.random.between(0.1f, 0.25f)}, Material::paint, b.newSeed());
  }
  b.roof(at + glm::vec3(-1.6f, -1.2f, 2.3f), at + glm::vec3(1.6f, 1.2f, 3.0f), {0.0f, 0.58f}, Material::awning, seed);
}

void addFountain(SceneBuilder& b, const glm::vec3& at) {
  b.cone(at, {6.0f, 0.18f, 1.0f}, Material::sandstone);
  b.cone(at, {4.8f, 0.50f, 1.0f}, Material::water);
  for (int i = 0; i < 24; ++i) {  // the rim, stone by stone
    const float angle = (static_cast<float>(i) + 0.5f) * 0.2617994f;
    b.cone(at + glm::vec3(4.75f * std::cos(angle), 4.75f * std::sin(angle), 0.0f), {0.66f, 0.72f, 0.9f},
           Material::sandstone, static_cast<std::uint32_t>(i));
  }
  b.cone(at, {0.6f, 2.6f, 0.55f}, Material::sandstone, 3);
  b.cone(at + glm::vec3(0.0f, 0.0f, 1.5f), {1.9f, 0.3f, 1.0f}, Material::sandstone, 4);
  b.cone(at + glm::vec3(0.0f, 0.0f, 1.8f), {1.75f, 0.06f, 1.0f}, Material::water);
  b.ball(at + glm::vec3(0.0f, 0.0f, 3.0f), {0.5f, 0.5f, 0.6f}, Material::sandstone, 5);
  b.foliage(at + glm::vec3(0.0f, 0.0f, 4.0f), {0.5f, 0.5f, 1.6f}, 1.2f, Material::spray, 6);
  for (int i = 0; i < 8; ++i) {
    const float angle = static_cast<float>(i) * 0.7854f;
    b.foliage(at + glm::vec3(2.9f * std::cos(angle), 2.9f * std::sin(angle), 0.9f), {0.35f, 0.35f, 0.9f}, 0.9f,
              Material::spray, 7);
  }
}

}  // namespace strata::synthetic
