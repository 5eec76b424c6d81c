#include "io/synthetic/facade.h"

#include <algorithm>
#include <cmath>

#include "io/synthetic/random.h"

namespace strata::synthetic {
namespace {

/// The layout of the openings of a wall, one in each cell of a grid of `pitch` x `storey` metres.
struct FacadeStyle {
  float pitch, storey;  ///< storey 0: one row over the whole height
  float halfWidth, sill, head;
  float depth;  ///< metres from the wall's face to the glass
  bool arched = false;
  bool groundFloor = false;  ///< doors and shop windows in the lowest row
};

FacadeStyle styleOf(Material material, std::uint32_t seed) {
  switch (material) {
    case Material::curtain:
      return {1.6f, 3.4f, 0.74f, 0.35f, 3.35f, 0.06f};
    case Material::church:
      return {4.2f, 0.0f, 0.75f, 2.4f, 0.0f, 0.3f, true};
    case Material::officeWall:
      return {2.4f, 0.0f, 0.95f, 0.9f, 2.4f, 0.12f};
    case Material::stone:
      return {2.9f, 3.5f, 0.65f, 0.9f, 2.85f, 0.22f, true, true};
    default: {
      const float width = 0.45f + 0.2f * cellHash(1, 0, seed);
      return {2.1f + 0.9f * cellHash(2, 0, seed), 3.1f, width, 0.85f, 2.45f, 0.14f, false, true};
    }
  }
}

/// One opening in coordinates from the middle of its cell's floor.
struct Opening {
  float left, right, bottom, top;
  float archTop = 0.0f;  ///< above `top`, a half circle of half the width; 0 = none
  enum class Kind { window, door, shop } kind = Kind::window;

  bool holds(float u, float v) const {
    if (u <= left || u >= right || v <= bottom) return false;
    if (v < top) return true;
    const float middle = (left + right) * 0.5f, radius = (right - left) * 0.5f;
    return archTop > 0.0f && (u - middle) * (u - middle) + (v - top) * (v - top) < radius * radius;
  }
};

/// One cell of the wall's grid, `pitch` x `storey` metres.
struct WallCell {
  int column, columns, level;
  float pitch, storey;
};

Opening openingOf(const FacadeStyle& style, const WallCell& cell, std::uint32_t seed) {
  Opening opening{-style.halfWidth, style.halfWidth, style.sill, style.head};
  if (style.storey <= 0.0f && style.arched) opening.top = cell.storey - style.halfWidth - 1.4f;
  opening.right = std::min(opening.right, cell.pitch * 0.46f);
  opening.left = -opening.right;
  opening.archTop = style.arched ? 1.0f : 0.0f;
  if (style.groundFloor && cell.level == 0) {
    const int door = static_cast<int>(cellHash(3, 0, seed) * static_cast<float>(cell.columns));
    if (cell.column == door) {
      opening = {-0.6f, 0.6f, 0.02f, 2.35f, 0.0f, Opening::Kind::door};
    } else if (cellHash(4, 0, seed) < 0.45f) {
      opening = {-cell.pitch * 0.42f, cell.pitch * 0.42f, 0.45f, 2.7f, 0.0f, Opening::Kind::shop};
    }
  }
  return opening;
}

constexpr float kFrameM = 0.07f;  // window frame

/// The surface of a pane, its frame included; u and v lie within the opening.
Surface paneSurface(Material material, const Opening& opening, float u, float v, std::uint32_t seed) {
  const float fromEdge = std::min(std::min(u - opening.left, opening.right - u), v - opening.bottom);
  const float height = (v - opening.bottom) / (opening.top - opening.bottom);
  Surface surface{{0.0f, 0.0f, 0.0f}, 0.2f, 0.0f, 6};
  const float chance = cellHash(5, 0, seed);
  if (opening.kind == Opening::Kind::door) {
    const glm::vec3 paints[4] = {
        {0.30f, 0.17f, 0.09f}, {0.10f, 0.27f, 0.20f}, {0.35f, 0.08f, 0.08f}, {0.12f, 0.18f, 0.33f}};
    const float panelU = std::abs(std::abs(u) - 0.28f), panelV = std::abs(std::fmod(v, 0.8f) - 0.4f);
    surface.albedo = paints[static_cast<int>(chance * 4.0f)] * (panelU > 0.2f || panelV > 0.3f ? 1.15f : 0.9f);
    surface.reflectance = 0.35f;
    return surface;
  }
  const bool bar =
      material != Material::curtain && (std::abs(u) < 0.03f || (v < opening.top && std::abs(height - 0.68f) < 0.018f));
  if (fromEdge < (material == Material::curtain ? 0.04f : kFrameM) || bar) {
    surface.albedo = material == Material::curtain || opening.kind == Opening::Kind::shop
                         ? glm::vec3(0.16f, 0.17f, 0.18f)
                     : material == Material::church ? glm::vec3(0.35f, 0.33f, 0.30f)
                                                    : glm::vec3(0.90f, 0.89f, 0.86f);
    surface.reflectance = 0.6f;
    return surface;
  }
  const float sheen = std::clamp(height + 0.35f * u, 0.0f, 1.0f);  // the sky mirrored in the pane
  surface.albedo = glm::mix(glm::vec3(0.10f, 0.13f, 0.17f), glm::vec3(0.42f, 0.53f, 0.62f), sheen * sheen);
  surface.glow = 0.45f;
  if (material == Material::curtain) {
    surface.albedo =
        glm::mix(glm::vec3(0.26f, 0.38f, 0.47f), glm::vec3(0.62f, 0.76f, 0.86f), 0.6f * sheen + 0.4f * chance);
  } else if (material == Material::church) {
    const int row = static_cast<int>(v * 4.0f), columnIndex = static_cast<int>(std::floor(u * 5.0f));
    const glm::vec3 stained[4] = {
        {0.55f, 0.12f, 0.14f}, {0.14f, 0.22f, 0.55f}, {0.72f, 0.58f, 0.16f}, {0.15f, 0.42f, 0.26f}};
    surface.albedo = stained[static_cast<int>(cellHash(columnIndex, row, seed) * 4.0f)];
  } else if (material == Material::officeWall) {
    surface.albedo = glm::mix(glm::vec3(0.55f, 0.68f, 0.52f), glm::vec3(0.72f, 0.86f, 0.97f),
                              std::clamp(height * 2.5f - 0.4f, 0.0f, 1.0f));
    surface.glow = 1.0f;
  } else if (opening.kind == Opening::Kind::shop) {
    if (cellHash(static_cast<int>(u * 6.0f), static_cast<int>(v * 3.0f), seed) > 0.72f && v < 1.6f) {
      surface.albedo =
          glm::vec3(cellHash(6, 0, seed), cellHash(7, static_cast<int>(u * 6.0f), seed), 0.4f) * 0.8f + 0.1f;
    }
  } else if (material != Material::curtain && chance < 0.45f && std::abs(u) > opening.right * (0.35f + chance)) {
    surface.albedo = glm::vec3(0.82f, 0.78f, 0.70f) * (0.86f + 0.14f * std::sin(u * 60.0f));  // a curtain's folds
  }
  return surface;
}

/// A ray at the face of a wall: its place in the cell, and the horizontal axis along the wall.
struct WallRay {
  float u, v;
  int axisU;
  glm::vec3 direction, normal;
};

/// Follows the ray from the wall's face to the pane, `depth` metres behind it, or to the side of the opening.
FacadeHit enterOpening(Material material, const Opening& opening, float depth, const WallRay& ray, std::uint32_t seed) {
  const float u = ray.u, v = ray.v;
  const float inwards = std::max(-glm::dot(ray.direction, ray.normal), 1e-3f);
  const float through = depth / inwards;
  const float du = ray.direction[ray.axisU], dv = ray.direction.z;
  if (opening.holds(u + du * through, v + dv * through))
    return {paneSurface(material, opening, u + du * through, v + dv * through, seed), ray.normal, through};
  const float sideways = du == 0.0f ? through : ((du > 0.0f ? opening.right : opening.left) - u) / du;
  const float upwards = dv == 0.0f ? through : ((dv > 0.0f ? opening.top : opening.bottom) - v) / dv;
  const bool jamb = sideways < upwards || upwards < 0.0f;
  FacadeHit hit{{{0.74f, 0.71f, 0.66f}, 0.6f, 0.0f, 6}, glm::vec3(0.0f)};
  hit.deeper = std::clamp(jamb ? sideways : upwards, 0.0f, through);
  if (jamb)
    hit.normal[ray.axisU] = du > 0.0f ? -1.0f : 1.0f;
  else
    hit.normal.z = dv > 0.0f ? -1.0f : 1.0f;
  return hit;
}

}  // namespace

FacadeHit hitFacade(const SurfacePoint& point, std::uint8_t windowSides, const glm::vec3& direction) {
  const glm::vec3 &normal = point.normal, &size = point.size, &local = point.local;
  const Material material = point.material;
  const std::uint32_t seed = point.seed;
  const int axisN = std::abs(normal.x) > 0.5f ? 0 : 1, axisU = 1 - axisN;
  const std::uint8_t sideBit =
      axisN == 0 ? (normal.x < 0.0f ? side::kWest : side::kEast) : (normal.y < 0.0f ? side::kSouth : side::kNorth);
  const bool wall = std::abs(normal.z) < 0.5f && (windowSides & sideBit) != 0;
  const auto onWall = [&](const Surface& surface) { return FacadeHit{surface, normal}; };
  if (!wall) return onWall(plainSurface(point));

  const FacadeStyle style = styleOf(material, seed);
  const float storey = style.storey > 0.0f ? style.storey : size.z;
  const int columns = std::max(1, static_cast<int>(size[axisU] / style.pitch));
  const float pitch = size[axisU] / static_cast<float>(columns);
  const int columnIndex = std::clamp(static_cast<int>(local[axisU] / pitch), 0, columns - 1);
  const int level = static_cast<int>(local.z / storey);
  const float u = local[axisU] - (static_cast<float>(columnIndex) + 0.5f) * pitch;
  const float v = local.z - static_cast<float>(level) * storey;
  if (level < std::max(1, static_cast<int>(size.z / storey + 0.01f))) {
    const Opening opening = openingOf(style, {columnIndex, columns, level, pitch, storey}, seed);
    const std::uint32_t paneSeed = seed + static_cast<std::uint32_t>(level * 131 + columnIndex * 7 + sideBit * 1009);
    if (opening.holds(u, v))
      return enterOpening(material, opening, style.depth, {u, v, axisU, direction, normal}, paneSeed);
    const bool trim = style.groundFloor && opening.kind == Opening::Kind::window && v > opening.bottom - 0.12f &&
                      v < opening.top + 0.16f && std::abs(u) < opening.right + 0.11f;
    if (trim && !(style.arched && v > opening.top)) return onWall({{0.80f, 0.77f, 0.71f}, 0.65f, 0.0f, 6});
    if (style.groundFloor && level > 0 && v < 0.16f)
      return onWall({{0.76f, 0.73f, 0.67f}, 0.65f, 0.0f, 6});  // string course
    if (opening.kind == Opening::Kind::shop && v > 2.7f) {     // the shop's sign
      const glm::vec3 sign(0.2f + 0.6f * cellHash(8, 0, seed), 0.2f + 0.4f * cellHash(9, 0, seed),
                           0.2f + 0.5f * cellHash(10, 0, seed));
      const bool letter =
          v > 2.8f && v < 3.0f && std::abs(u) < pitch * 0.35f &&
          cellHash(static_cast<int>(std::floor(u * 9.0f)), static_cast<int>(v * 14.0f), seed + 5) > 0.45f;
      return onWall({letter ? glm::vec3(0.93f, 0.92f, 0.86f) : sign, 0.45f, 0.0f, 6});
    }
  }
  return onWall(plainSurface(point));
}

}  // namespace strata::synthetic
