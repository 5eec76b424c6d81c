#include "io/synthetic/material.h"

#include <algorithm>
#include <cmath>

#include "io/synthetic/asprs.h"
#include "io/synthetic/random.h"
#include "io/synthetic/shape.h"
#include "io/synthetic/street_grid.h"

namespace strata::synthetic {
namespace {

using asprs::kBuilding;
using asprs::kGround;
using asprs::kUnclassified;

/// The two coordinates that lie in a surface: along it and up (walls), or x and y (floors).
glm::vec2 planar(const glm::vec3& p, const glm::vec3& normal) {
  if (std::abs(normal.z) > 0.7f) return {p.x, p.y};
  return {std::abs(normal.x) > std::abs(normal.y) ? p.y : p.x, p.z};
}

float grain(const glm::vec2& p, float perMetre, std::uint32_t seed) {
  return valueNoise(p.x * perMetre, p.y * perMetre, seed).value;
}

int cellOf(float x) { return static_cast<int>(std::floor(x)); }

/// Rows of bricks or slabs, every other one shifted; true in the joints.
struct Masonry {
  int row, columnIndex;
  bool joint;
};
Masonry masonry(const glm::vec2& p, float width, float height, float jointWidth) {
  const int row = cellOf(p.y / height);
  const float along = p.x / width + ((row & 1) != 0 ? 0.5f : 0.0f);
  const int columnIndex = cellOf(along);
  const float fu = (along - static_cast<float>(columnIndex)) * width, fv = p.y - static_cast<float>(row) * height;
  return {row, columnIndex, fu < jointWidth || fv < jointWidth};
}

glm::vec3 pick(const glm::vec3* palette, int count, std::uint32_t seed) {
  return palette[static_cast<int>(cellHash(11, 3, seed) * static_cast<float>(count))];
}

Surface brickSurface(const glm::vec2& p, std::uint32_t seed) {
  static constexpr glm::vec3 kBricks[4] = {
      {0.58f, 0.27f, 0.20f}, {0.50f, 0.24f, 0.19f}, {0.66f, 0.42f, 0.28f}, {0.45f, 0.30f, 0.26f}};
  const Masonry m = masonry(p, 0.25f, 0.075f, 0.012f);
  if (m.joint) return {{0.66f, 0.63f, 0.58f}, 0.5f, 0.0f, kBuilding};
  return {pick(kBricks, 4, seed) * (0.8f + 0.4f * cellHash(m.columnIndex, m.row, seed)), 0.4f, 0.0f, kBuilding};
}

Surface plasterSurface(const glm::vec2& p, std::uint32_t seed) {
  static constexpr glm::vec3 kPlasters[8] = {{0.90f, 0.84f, 0.70f}, {0.86f, 0.70f, 0.55f}, {0.88f, 0.88f, 0.84f},
                                             {0.78f, 0.83f, 0.76f}, {0.92f, 0.79f, 0.55f}, {0.74f, 0.79f, 0.86f},
                                             {0.88f, 0.66f, 0.60f}, {0.82f, 0.78f, 0.72f}};
  const float stains = 0.90f + 0.10f * grain(p, 0.6f, seed) + 0.05f * (grain(p, 9.0f, seed + 1) - 0.5f);
  return {pick(kPlasters, 8, seed) * stains, 0.7f, 0.0f, kBuilding};
}

Surface stoneSurface(const glm::vec2& p, std::uint32_t seed, const glm::vec3& base, float block) {
  const Masonry m = masonry(p, block, block * 0.5f, 0.015f);
  const float tone = 0.88f + 0.2f * cellHash(m.columnIndex, m.row, seed) + 0.1f * (grain(p, 2.5f, seed) - 0.5f);
  return {base * (m.joint ? 0.72f : tone), 0.6f, 0.0f, kBuilding};
}

Surface roofSurface(const glm::vec3& p, const glm::vec3& normal, std::uint32_t seed, bool slate) {
  static constexpr glm::vec3 kTiles[4] = {
      {0.66f, 0.30f, 0.20f}, {0.58f, 0.26f, 0.19f}, {0.72f, 0.38f, 0.24f}, {0.50f, 0.28f, 0.22f}};
  if (normal.z < 0.1f) return plasterSurface(planar(p, normal), seed);  // the gable's wall
  const float along = std::abs(normal.x) > std::abs(normal.y) ? p.y : p.x;
  const Masonry m = masonry({along, p.z}, slate ? 0.4f : 0.3f, slate ? 0.16f : 0.22f, 0.03f);
  const glm::vec3 base = slate ? glm::vec3(0.30f, 0.32f, 0.36f) : pick(kTiles, 4, seed);
  const float moss = grain({p.x, p.y}, 0.5f, seed);
  const glm::vec3 tile = base * ((m.joint ? 0.62f : 0.88f) + 0.24f * cellHash(m.columnIndex, m.row, seed));
  return {glm::mix(tile, glm::vec3(0.33f, 0.35f, 0.22f), std::max(0.0f, moss - 0.72f)), slate ? 0.25f : 0.35f, 0.0f,
          kBuilding};
}

Surface grassSurface(const glm::vec2& p) {
  const float patch = grain(p, 0.15f, 71), blade = grain(p, 14.0f, 72);
  const glm::vec3 base = glm::mix(glm::vec3(0.26f, 0.44f, 0.15f), glm::vec3(0.46f, 0.52f, 0.22f), patch);
  return {base * (0.72f + 0.5f * blade), 0.75f, 0.0f, asprs::kLowVegetation};
}

Surface pavementSurface(const glm::vec2& p) {
  const Masonry m = masonry(p, 0.6f, 0.4f, 0.012f);
  const float tone =
      (m.joint ? 0.66f : 0.86f) + 0.14f * cellHash(m.columnIndex, m.row, 31) - 0.08f * grain(p, 0.4f, 32);
  return {glm::vec3(0.62f, 0.59f, 0.55f) * tone, 0.45f, 0.0f, kGround};
}

Surface waterSurface(const glm::vec2& p) {
  const float ripple = grain(p, 3.0f, 41) * 0.6f + grain(p, 9.0f, 42) * 0.4f;
  return {glm::mix(glm::vec3(0.15f, 0.34f, 0.42f), glm::vec3(0.52f, 0.70f, 0.76f), ripple * ripple), 0.06f, 0.25f,
          asprs::kWater};
}

Surface leafSurface(const glm::vec3& local, const glm::vec3& size, std::uint32_t seed) {
  const float autumn = cellHash(12, 0, seed);
  const glm::vec3 base = autumn < 0.12f
                             ? glm::vec3(0.62f, 0.44f, 0.14f)
                             : glm::mix(glm::vec3(0.20f, 0.40f, 0.12f), glm::vec3(0.38f, 0.52f, 0.17f), autumn);
  const float leaf = cellHash(cellOf(local.x * 9.0f) + cellOf(local.z * 7.0f) * 57, cellOf(local.y * 9.0f), seed);
  const glm::vec3 centred = local / size * 2.0f - 1.0f;
  const float outer = std::min(glm::dot(centred, centred), 1.0f);  // the inside of a crown is dark
  return {base * (0.65f + 0.5f * leaf) * (0.5f + 0.5f * outer), 0.8f, 0.0f, asprs::kHighVegetation};
}

Surface bookSurface(const glm::vec2& p, std::uint32_t seed) {
  static constexpr glm::vec3 kCovers[6] = {{0.60f, 0.16f, 0.14f}, {0.15f, 0.25f, 0.48f}, {0.84f, 0.79f, 0.66f},
                                           {0.14f, 0.38f, 0.27f}, {0.85f, 0.60f, 0.20f}, {0.22f, 0.20f, 0.24f}};
  const int book = cellOf(p.x / 0.035f);
  const float in = p.x / 0.035f - static_cast<float>(book);
  const bool label = p.y > 0.12f && p.y < 0.19f && cellHash(book, 2, seed) > 0.4f;
  const glm::vec3 cover = pick(kCovers, 6, seed + static_cast<std::uint32_t>(book) * 7919U);
  return {(label ? glm::vec3(0.88f, 0.84f, 0.7f) : cover) * (in < 0.12f ? 0.4f : 1.0f), 0.5f, 0.0f, kUnclassified};
}

Surface clockSurface(const glm::vec3& local, const glm::vec3& size, const glm::vec3& normal) {
  const glm::vec2 p = planar(local - size * 0.5f, normal) / (size.z * 0.5f);
  const float r = glm::length(p);
  const float angle = std::atan2(p.x, p.y), hour = std::abs(std::fmod(angle + 6.2831853f, 0.5235988f) - 0.2617994f);
  if (r > 0.95f) return {{0.70f, 0.56f, 0.24f}, 0.5f, 0.0f, kBuilding};
  const bool mark = r > 0.76f && hour > 0.20f;
  const bool hands = (std::abs(p.x) < 0.05f && p.y > -0.1f && p.y < 0.7f) ||
                     (std::abs(p.y - p.x * 0.3f) < 0.07f && p.x > -0.1f && p.x < 0.5f);
  return {mark || hands ? glm::vec3(0.08f) : glm::vec3(0.92f, 0.90f, 0.83f), 0.6f, 0.0f, kBuilding};
}

Surface whiteboardSurface(const glm::vec2& p, std::uint32_t seed) {
  const float line = p.y * 7.0f,
              wave = 0.12f * std::sin(p.x * 40.0f + static_cast<float>(seed % 10)) + 0.1f * std::sin(p.x * 91.0f);
  const bool ink = std::abs(line - std::floor(line) - 0.5f + wave) < 0.09f &&
                   cellHash(cellOf(p.x * 2.5f), cellOf(line), seed) > 0.45f;
  return {ink ? glm::vec3(0.12f, 0.22f, 0.55f) : glm::vec3(0.95f, 0.95f, 0.94f), ink ? 0.3f : 0.9f, 0.0f,
          kUnclassified};
}

Surface pictureSurface(const glm::vec2& p, const glm::vec3& local, const glm::vec3& size, const glm::vec3& normal,
                       std::uint32_t seed) {
  const glm::vec2 inner = planar(local, normal), extent = planar(size, normal);
  const glm::vec2 edge = glm::min(inner, extent - inner);
  if (std::min(edge.x, edge.y) < 0.04f) return {{0.18f, 0.13f, 0.09f}, 0.3f, 0.0f, kUnclassified};
  const float hills = 0.45f + 0.25f * grain(p, 3.0f, seed), height = inner.y / extent.y;
  const glm::vec3 sky = glm::mix(glm::vec3(0.95f, 0.72f, 0.45f), glm::vec3(0.35f, 0.52f, 0.75f), height);
  return {height > hills ? sky : glm::vec3(0.20f, 0.32f, 0.26f) * (0.6f + height), 0.6f, 0.0f, kUnclassified};
}

Surface parquetSurface(const glm::vec2& p) {
  const Masonry m = masonry(p, 1.4f, 0.14f, 0.006f);
  const float veins = grain({p.x * 1.5f, p.y * 30.0f}, 1.0f, 51);
  return {glm::vec3(0.62f, 0.44f, 0.27f) *
              ((m.joint ? 0.5f : 0.8f) + 0.25f * cellHash(m.columnIndex, m.row, 52) + 0.12f * veins),
          0.55f, 0.0f, kGround};
}

/// The parts of a city that are one colour with a little grain.
Surface simpleSurface(Material material, std::uint32_t seed, const glm::vec2& p) {
  static constexpr glm::vec3 kCars[7] = {{0.72f, 0.10f, 0.10f}, {0.12f, 0.22f, 0.50f}, {0.88f, 0.88f, 0.88f},
                                         {0.10f, 0.10f, 0.11f}, {0.55f, 0.57f, 0.60f}, {0.85f, 0.72f, 0.15f},
                                         {0.12f, 0.36f, 0.24f}};
  static constexpr glm::vec3 kFabrics[4] = {
      {0.16f, 0.25f, 0.38f}, {0.55f, 0.20f, 0.15f}, {0.20f, 0.22f, 0.24f}, {0.25f, 0.42f, 0.38f}};
  const float fine = 0.92f + 0.16f * (grain(p, 12.0f, seed) - 0.25f);
  switch (material) {
    case Material::gravel:
      return {glm::vec3(0.70f, 0.62f, 0.48f) * (0.7f + 0.5f * grain(p, 18.0f, 61)), 0.5f, 0.0f, kGround};
    case Material::flatRoof:
      return {glm::vec3(0.46f, 0.45f, 0.44f) * (0.7f + 0.4f * grain(p, 0.8f, seed)) * fine, 0.3f, 0.0f, kBuilding};
    case Material::bark:
      return {glm::vec3(0.32f, 0.24f, 0.17f) * (0.6f + 0.7f * grain({p.x * 20.0f, p.y * 4.0f}, 1.0f, seed)), 0.4f, 0.0f,
              asprs::kHighVegetation};
    case Material::metal:
      return {glm::vec3(0.26f, 0.28f, 0.29f) * fine, 0.3f, 0.0f, kUnclassified};
    case Material::lamp:
      return {{1.0f, 0.96f, 0.84f}, 0.9f, 1.0f, kUnclassified};
    case Material::paint:
      return {pick(kCars, 7, seed), 0.55f, 0.0f, kUnclassified};
    case Material::glass:
      return {{0.14f, 0.18f, 0.22f}, 0.1f, 0.3f, kUnclassified};
    case Material::rubber:
      return {glm::vec3(0.09f), 0.06f, 0.0f, kUnclassified};
    case Material::wood:
      return {glm::vec3(0.58f, 0.42f, 0.26f) * (0.75f + 0.35f * grain({p.x * 3.0f, p.y * 25.0f}, 1.0f, seed)), 0.55f,
              0.0f, kUnclassified};
    case Material::spray:
      return {{0.86f, 0.92f, 0.95f}, 0.15f, 0.3f, kUnclassified};
    case Material::carpet:
      return {glm::mix(glm::vec3(0.36f, 0.40f, 0.46f), glm::vec3(0.46f, 0.42f, 0.38f), cellHash(13, 0, seed)) *
                  (0.75f + 0.4f * grain(p, 45.0f, 62)) * (masonry(p, 0.5f, 0.5f, 0.01f).joint ? 0.8f : 1.0f),
              0.4f, 0.0f, kGround};
    case Material::fabric:
      return {pick(kFabrics, 4, seed) * (0.8f + 0.3f * grain(p, 60.0f, seed)), 0.45f, 0.0f, kUnclassified};
    default:
      return {glm::vec3(0.5f) * fine, 0.5f, 0.0f, kUnclassified};
  }
}

}  // namespace

bool hasWindows(Material material) {
  return material == Material::brick || material == Material::plaster || material == Material::stone ||
         material == Material::curtain || material == Material::church || material == Material::officeWall;
}

Surface plainSurface(const SurfacePoint& point) {
  const auto& [material, seed, position, local, size, normal] = point;
  const glm::vec2 p = planar(position, normal);
  if (hasWindows(material) && normal.z > 0.5f) return simpleSurface(Material::flatRoof, seed, p);
  switch (material) {
    case Material::street:
      return streetSurface({position.x, position.y});
    case Material::pavement:
      return pavementSurface(p);
    case Material::grass:
      return grassSurface(p);
    case Material::water:
      return waterSurface(p);
    case Material::brick:
      return brickSurface(p, seed);
    case Material::plaster:
      return plasterSurface(p, seed);
    case Material::stone:
      return stoneSurface(p, seed, {0.78f, 0.72f, 0.60f}, 1.0f);
    case Material::church:
      return stoneSurface(p, seed, {0.80f, 0.73f, 0.60f}, 0.8f);
    case Material::curtain:
      return {{0.56f, 0.59f, 0.62f}, 0.4f, 0.0f, kBuilding};
    case Material::tiles:
      return roofSurface(position, normal, seed, false);
    case Material::slate:
      return roofSurface(position, normal, seed, true);
    case Material::leaf:
      return leafSurface(local, size, seed);
    case Material::awning: {
      const float stripe = std::floor((position.x + position.y) * 2.2f);
      const glm::vec3 colour(0.35f + 0.5f * cellHash(14, 0, seed), 0.15f + 0.3f * cellHash(15, 0, seed),
                             0.15f + 0.4f * cellHash(16, 0, seed));
      return {std::fmod(std::abs(stripe), 2.0f) < 0.5f ? glm::vec3(0.93f, 0.91f, 0.86f) : colour, 0.6f, 0.0f,
              kUnclassified};
    }
    case Material::sandstone:
      return stoneSurface(p, seed, {0.82f, 0.76f, 0.64f}, 1.2f);
    case Material::clock:
      return clockSurface(local, size, normal);
    case Material::parquet:
      return parquetSurface(p);
    case Material::wall:
    case Material::officeWall: {
      const glm::vec3 tint =
          glm::mix(glm::vec3(0.88f, 0.87f, 0.84f), glm::vec3(0.74f, 0.82f, 0.84f), cellHash(17, 0, seed) * 0.6f);
      if (position.z < 0.1f) return {{0.93f, 0.92f, 0.90f}, 0.75f, 0.0f, kBuilding};  // skirting board
      return {tint * (0.95f + 0.05f * grain(p, 7.0f, 63)), 0.75f, 0.0f, kBuilding};
    }
    case Material::ceiling:
      return {glm::vec3(masonry(p, 0.6f, 0.6f, 0.015f).joint ? 0.70f : 0.93f), 0.85f, 0.0f, kBuilding};
    case Material::books:
      return bookSurface({p.x, local.z}, seed);
    case Material::screen: {
      const bool front = std::abs(normal.z) < 0.5f && std::min(local.z, size.z - local.z) > 0.02f;
      const bool text = cellHash(cellOf(p.x * 55.0f), cellOf(p.y * 45.0f), seed) > 0.62f;
      return {!front ? glm::vec3(0.08f)
              : text ? glm::vec3(0.75f, 0.82f, 0.88f)
                     : glm::vec3(0.12f, 0.20f, 0.34f),
              0.15f, front ? 0.8f : 0.0f, kUnclassified};
    }
    case Material::whiteboard:
      return whiteboardSurface(p, seed);
    case Material::picture:
      return pictureSurface(p, local, size, normal, seed);
    default:
      return simpleSurface(material, seed, p);
  }
}

}  // namespace strata::synthetic
