#include <algorithm>
#include <cmath>

#include "io/synthetic/scene_builder.h"
#include "io/synthetic/street_grid.h"

namespace strata::synthetic {
namespace {

constexpr float kStorey = 3.1f;
constexpr float kFloor = city::kKerb;  // houses stand on the raised block

Material facade(SceneBuilder& b) {
  static constexpr Material kFacades[6] = {Material::plaster, Material::plaster, Material::plaster,
                                           Material::brick,   Material::brick,   Material::stone};
  return kFacades[b.random.below(6)];
}

void addChimney(SceneBuilder& b, const glm::vec2& at, float foot, float top) {
  b.block({at.x, at.y, foot}, {0.6f, 0.6f, top - foot}, Material::brick);
}

/// One house of a row. Its ridge runs along its street; corner houses have hipped roofs.
struct House {
  glm::vec2 min, max;  ///< outer walls
  int storeys;
  glm::vec2 out;  ///< from the ridge to the street
  bool corner;
};

/// Small house fronts on the slope of the roof.
void addDormers(SceneBuilder& b, const House& house, float eaves, float slope, std::uint32_t seed) {
  const auto& [min, max, storeys, out, corner] = house;
  const bool alongX = out.x == 0.0f;
  const float length = alongX ? max.x - min.x : max.y - min.y;
  const int count = static_cast<int>(length / 3.6f);
  for (int i = 0; i < count; ++i) {
    const float along = (static_cast<float>(i) + 0.5f) * length / static_cast<float>(count);
    const float front = 0.9f, depth = 2.4f;  // metres behind the wall
    const glm::vec2 foot = alongX ? glm::vec2(min.x + along, out.y > 0.0f ? max.y - front : min.y + front)
                                  : glm::vec2(out.x > 0.0f ? max.x - front : min.x + front, min.y + along);
    const glm::vec2 across = alongX ? glm::vec2(0.75f, 0.0f) : glm::vec2(0.0f, 0.75f);
    const glm::vec2 low = glm::min(foot - across, foot - across - out * depth),
                    high = glm::max(foot + across, foot + across - out * depth);
    const float z = eaves + slope * front - 0.3f;
    b.box({low.x, low.y, z}, {high.x, high.y, z + 1.5f}, Material::plaster, seed);
    const glm::vec2 face = foot + out * 0.02f;
    const glm::vec2 half = across * 0.7f + glm::abs(out) * 0.02f;
    b.box({face.x - half.x, face.y - half.y, z + 0.45f}, {face.x + half.x, face.y + half.y, z + 1.35f}, Material::glass,
          seed);
    addPitchedRoof(b, {low - 0.05f, high + 0.05f, z + 1.5f, 0.8f, !alongX, false}, Material::tiles, seed);
  }
}

void addHouse(SceneBuilder& b, const House& house) {
  const auto& [min, max, storeys, out, corner] = house;
  const std::uint32_t seed = b.newSeed();
  const Material wall = facade(b);
  const float eaves = kFloor + static_cast<float>(storeys) * (wall == Material::stone ? 3.5f : kStorey) + 0.5f;
  Primitive& body = b.box({min.x, min.y, kFloor}, {max.x, max.y, eaves}, wall, seed);
  body.windowSides = corner ? side::kAll : out.x != 0.0f ? side::kWest | side::kEast : side::kSouth | side::kNorth;
  if (!corner && b.random.chance(0.18f)) {  // flat roof with a parapet and a hut for the lift
    const glm::vec2 middle = (min + max) * 0.5f;
    b.block({middle.x, middle.y, eaves}, {2.6f, 2.6f, 2.4f}, Material::plaster, seed);
    b.block({middle.x + 2.4f, middle.y + 1.0f, eaves}, {1.2f, 0.8f, 0.9f}, Material::metal);
    return;
  }
  const Material cover = b.random.chance(0.3f) ? Material::slate : Material::tiles;
  const float slope = b.random.between(0.65f, 1.0f);
  // Cornice below the eaves.
  b.box({min.x - 0.18f, min.y - 0.18f, eaves - 0.25f}, {max.x + 0.18f, max.y + 0.18f, eaves}, Material::sandstone,
        seed);
  addPitchedRoof(b, {min - 0.25f, max + 0.25f, eaves, slope, out.x == 0.0f, corner}, cover, seed);
  const float ridge = eaves + slope * 0.5f * (out.x == 0.0f ? max.y - min.y : max.x - min.x);
  if (!corner && b.random.chance(0.55f)) addDormers(b, house, eaves, slope, seed);
  const glm::vec2 spot = glm::mix(min, max, glm::vec2(b.random.between(0.3f, 0.4f), b.random.between(0.3f, 0.4f)));
  addChimney(b, spot, eaves, ridge + 0.5f);
}

/// Houses of random widths between two corners. `from` and `to` run along the street side of the block.
void addRow(SceneBuilder& b, const glm::vec2& min, const glm::vec2& max, const glm::vec2& out, int storeys) {
  const int axis = out.x != 0.0f ? 1 : 0;
  float at = min[axis];
  while (at < max[axis] - 0.1f) {
    float width = b.random.between(7.5f, 13.0f);
    if (max[axis] - at - width < 7.0f) width = max[axis] - at;
    glm::vec2 low = min, high = max;
    low[axis] = at;
    high[axis] = at + width;
    addHouse(b, {low, high, std::max(2, storeys + b.random.below(3) - 1), out, false});
    at += width;
  }
}

}  // namespace

void addPitchedRoof(SceneBuilder& b, const PitchedRoof& roof, Material material, std::uint32_t seed) {
  const auto& [min, max, eaves, slope, ridgeAlongX, hip] = roof;
  const glm::vec2 half = (max - min) * 0.5f;
  const float run = hip ? std::min(half.x, half.y) : ridgeAlongX ? half.y : half.x;
  const glm::vec2 slopes = hip ? glm::vec2(slope) : ridgeAlongX ? glm::vec2(0.0f, slope) : glm::vec2(slope, 0.0f);
  b.roof({min.x, min.y, eaves}, {max.x, max.y, eaves + slope * run}, slopes, material, seed);
}

void addPerimeterBlock(SceneBuilder& b, const glm::vec2& min, const glm::vec2& max) {
  constexpr float kDepth = 12.0f;
  const int storeys = 3 + b.random.below(3);
  for (const glm::vec2& corner :
       {min, glm::vec2(max.x - kDepth, min.y), glm::vec2(min.x, max.y - kDepth), max - kDepth}) {
    addHouse(b, {corner, corner + kDepth, storeys + b.random.below(2), {0.0f, 1.0f}, true});
  }
  addRow(b, {min.x + kDepth, min.y}, {max.x - kDepth, min.y + kDepth}, {0.0f, -1.0f}, storeys);
  addRow(b, {min.x + kDepth, max.y - kDepth}, {max.x - kDepth, max.y}, {0.0f, 1.0f}, storeys);
  addRow(b, {min.x, min.y + kDepth}, {min.x + kDepth, max.y - kDepth}, {-1.0f, 0.0f}, storeys);
  addRow(b, {max.x - kDepth, min.y + kDepth}, {max.x, max.y - kDepth}, {1.0f, 0.0f}, storeys);
  const glm::vec2 low = min + kDepth, high = max - kDepth;  // the yard
  b.box({low.x + 2.0f, low.y + 2.0f, 0.0f}, {high.x - 2.0f, high.y - 2.0f, kFloor + 0.05f}, Material::grass);
  for (int i = 0; i < 6; ++i) {
    const glm::vec2 at = glm::mix(low + 5.0f, high - 5.0f, glm::vec2(b.random.uniformFloat(), b.random.uniformFloat()));
    addTree(b, {at.x, at.y, kFloor}, b.random.between(5.0f, 10.0f));
  }
}

void addVillas(SceneBuilder& b, const glm::vec2& min, const glm::vec2& max) {
  b.box({min.x, min.y, 0.0f}, {max.x, max.y, kFloor + 0.05f}, Material::grass);
  const glm::vec2 lot = (max - min) / glm::vec2(3.0f);
  for (int i = 0; i < 9; ++i) {
    const glm::vec2 corner = min + lot * glm::vec2(static_cast<float>(i % 3), static_cast<float>(i / 3));
    const glm::vec2 middle = corner + lot * 0.5f;
    if (i == 4) {
      for (int tree = 0; tree < 4; ++tree) {
        addTree(b, {middle.x + b.random.between(-6.0f, 6.0f), middle.y + b.random.between(-6.0f, 6.0f), kFloor},
                b.random.between(6.0f, 12.0f));
      }
      continue;
    }
    const glm::vec2 half(b.random.between(4.2f, 5.8f), b.random.between(4.2f, 5.8f));
    addHouse(b, {middle - half, middle + half, 2, {0.0f, 1.0f}, true});
    for (int tree = 0; tree < 2; ++tree) {
      const glm::vec2 at = corner + glm::vec2(b.random.between(1.8f, 2.6f), b.random.between(2.0f, lot.y - 2.0f));
      if (b.random.chance(0.4f))
        addConifer(b, {at.x, at.y, kFloor}, b.random.between(4.0f, 9.0f));
      else
        addTree(b, {at.x, at.y, kFloor}, b.random.between(4.0f, 7.0f));
    }
    // A hedge along the lot's southern edge.
    b.foliage({middle.x, corner.y + 0.5f, kFloor + 0.5f}, {lot.x * 0.42f, 0.45f, 0.75f}, 0.12f, Material::leaf,
              b.newSeed());
  }
}

void addTowers(SceneBuilder& b, const glm::vec2& min, const glm::vec2& max) {
  const glm::vec2 middle = (min + max) * 0.5f;
  b.box({min.x + 4.0f, min.y + 4.0f, kFloor}, {max.x - 4.0f, max.y - 4.0f, 7.2f}, Material::stone, b.newSeed())
      .windowSides = side::kAll;
  for (const float sign : {-1.0f, 1.0f}) {
    const float height = b.random.between(34.0f, 58.0f);
    const glm::vec2 at = middle + glm::vec2(sign * 12.0f, sign * 9.0f), half(8.0f, 9.5f);
    b.box({at.x - half.x, at.y - half.y, 7.2f}, {at.x + half.x, at.y + half.y, height}, Material::curtain, b.newSeed())
        .windowSides = side::kAll;
    b.block({at.x, at.y, height}, {9.0f, 11.0f, 3.0f}, Material::metal);
    b.cone({at.x, at.y, height + 3.0f}, {0.25f, 9.0f, 0.3f}, Material::metal);
  }
  for (int i = 0; i < 8; ++i) {  // on the podium's roof
    b.block({b.random.between(min.x + 6.0f, max.x - 6.0f), b.random.between(min.y + 6.0f, max.y - 6.0f), 7.2f},
            {2.4f, 1.4f, 1.1f}, Material::metal);
  }
}

void addChurch(SceneBuilder& b, const glm::vec3& at) {
  const std::uint32_t seed = b.newSeed();
  const float x = at.x, y = at.y, z = at.z;
  b.box({x - 15.0f, y - 6.0f, z}, {x + 13.0f, y + 6.0f, z + 13.0f}, Material::church, seed).windowSides = side::kAll;
  b.roof({x - 15.4f, y - 6.5f, z + 13.0f}, {x + 13.4f, y + 6.5f, z + 21.0f}, {0.0f, 1.25f}, Material::slate, seed);
  b.box({x - 13.0f, y - 10.0f, z}, {x + 10.0f, y + 10.0f, z + 6.5f}, Material::church, seed + 1).windowSides =
      side::kAll;  // aisles
  b.roof({x - 13.3f, y - 10.3f, z + 6.5f}, {x + 10.3f, y + 10.3f, z + 9.0f}, {0.0f, 0.6f}, Material::slate, seed);
  for (int i = 0; i < 6; ++i) {  // buttresses
    const float along = x - 12.6f + 4.4f * static_cast<float>(i);
    for (const float sign : {-1.0f, 1.0f})
      b.block({along, y + sign * 10.4f, z}, {0.7f, 1.0f, 5.4f}, Material::sandstone, seed);
  }
  b.cone({x + 13.0f, y, z}, {5.4f, 11.0f, 1.0f}, Material::sandstone, seed);  // apse
  b.cone({x + 13.0f, y, z + 11.0f}, {5.8f, 5.0f, 0.0f}, Material::slate, seed);
  // Tower in front of the nave, with a clock on every side and a spire.
  const float tx = x - 19.0f;
  b.box({tx - 4.2f, y - 4.2f, z}, {tx + 4.2f, y + 4.2f, z + 22.0f}, Material::church, seed + 2).windowSides =
      side::kAll;
  b.box({tx - 4.5f, y - 4.5f, z + 22.0f}, {tx + 4.5f, y + 4.5f, z + 22.6f}, Material::sandstone, seed);
  b.box({tx - 3.9f, y - 3.9f, z + 22.6f}, {tx + 3.9f, y + 3.9f, z + 31.0f}, Material::church, seed + 3).windowSides =
      side::kAll;
  b.box({tx - 4.0f, y - 1.5f, z + 27.8f}, {tx + 4.0f, y + 1.5f, z + 30.8f}, Material::clock, seed);
  b.box({tx - 1.5f, y - 4.0f, z + 27.8f}, {tx + 1.5f, y + 4.0f, z + 30.8f}, Material::clock, seed);
  b.box({tx - 4.4f, y - 4.4f, z + 31.0f}, {tx + 4.4f, y + 4.4f, z + 31.6f}, Material::sandstone, seed);
  b.roof({tx - 4.0f, y - 4.0f, z + 31.6f}, {tx + 4.0f, y + 4.0f, z + 52.0f}, {5.1f, 5.1f}, Material::slate, seed);
  for (const glm::vec2& corner :
       {glm::vec2(-1.0f, -1.0f), glm::vec2(-1.0f, 1.0f), glm::vec2(1.0f, -1.0f), glm::vec2(1.0f, 1.0f)}) {
    b.cone({tx + corner.x * 3.9f, y + corner.y * 3.9f, z + 31.6f}, {0.7f, 4.5f, 0.0f}, Material::sandstone, seed);
  }
  b.block({tx, y, z + 51.5f}, {0.15f, 0.15f, 3.0f}, Material::lamp);
  b.block({tx, y, z + 53.4f}, {0.15f, 1.3f, 0.15f}, Material::lamp);
  for (int step = 0; step < 4; ++step) {  // to the portal
    const float out = 1.6f - 0.4f * static_cast<float>(step);
    b.box({tx - 4.2f - out, y - 3.0f - out, z}, {tx - 4.2f, y + 3.0f + out, z + 0.16f * static_cast<float>(step + 1)},
          Material::sandstone, seed);
  }
  b.box({tx - 4.35f, y - 1.3f, z + 0.6f}, {tx - 4.1f, y + 1.3f, z + 4.2f}, Material::wood, seed);
}

}  // namespace strata::synthetic
