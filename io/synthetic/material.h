#pragma once
#include <cstdint>

#include <glm/glm.hpp>

#include "io/synthetic/surface.h"

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

/// A point on an object.
struct SurfacePoint {
  Material material;
  std::uint32_t seed;  ///< picks the object's colour
  glm::vec3 position;  ///< in the scene
  glm::vec3 local;     ///< relative to the lower corner of the object
  glm::vec3 size;      ///< of the object
  glm::vec3 normal;
};

/// The surface at a point, without regard to windows.
Surface plainSurface(const SurfacePoint& point);

/// True for the materials of walls, whose boxes may carry windows (facade.h).
bool hasWindows(Material material);

}  // namespace strata::synthetic
