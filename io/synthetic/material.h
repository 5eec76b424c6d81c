#pragma once
#include <cstdint>

#include <glm/glm.hpp>

namespace strata::synthetic {

enum class Material : std::uint8_t {
  street,    ///< the city's ground: carriageways with markings, meadow outside
  pavement,  ///< pavements and squares
  grass,
  gravel,
  water,
  brick,  ///< facades with windows: brick, plaster, stone, curtain, church
  plaster,
  stone,
  curtain,  ///< glass tower
  church,
  tiles,  ///< sloping roofs: tiles, slate
  slate,
  flatRoof,
  bark,
  leaf,
  metal,
  lamp,   ///< shines
  paint,  ///< of cars
  glass,
  rubber,
  wood,
  awning,
  sandstone,  ///< fountain, steps, statues
  clock,
  spray,
  parquet,  ///< indoors from here on
  carpet,
  wall,
  officeWall,  ///< outer wall with windows
  ceiling,
  books,
  screen,
  fabric,
  whiteboard,
  picture,
};

/// What light and laser find at one point of a surface.
struct Surface {
  glm::vec3 albedo{0.5f};
  float reflectance = 0.5f;  ///< for the laser, 0 to 1
  float glow = 0.0f;         ///< share of the albedo that shows without any light
  std::uint8_t classification = 1;
};

/// The surface without windows. `local` is the position relative to the lower corner of the object and `size` its size;
/// `seed` picks the object's colour.
Surface plainSurface(Material material, std::uint32_t seed, const glm::vec3& position, const glm::vec3& local,
                     const glm::vec3& size, const glm::vec3& normal);

/// Sides of a box that carry windows.
namespace side {
inline constexpr std::uint8_t kWest = 1, kEast = 2, kSouth = 4, kNorth = 8, kAll = 15;
}  // namespace side

/// A wall that a ray has reached; facades move the point into their windows.
struct WallHit {
  glm::vec3 local;      ///< relative to the box's lower corner
  glm::vec3 normal;     ///< of the box's side on entry, of the surface that was hit on return
  float deeper = 0.0f;  ///< metres along the ray behind the box's side
};
/// Surface of a box with windows, which lie a few centimetres behind the wall. `position` is the point on the box.
Surface facadeSurface(Material material, std::uint32_t seed, std::uint8_t windowSides, const glm::vec3& position,
                      const glm::vec3& size, const glm::vec3& direction, WallHit& hit);
bool hasWindows(Material material);

}  // namespace strata::synthetic
