#include "io/synthetic/street_grid.h"

#include <cmath>

#include "io/synthetic/asprs.h"
#include "io/synthetic/random.h"

namespace strata::synthetic {

Surface streetSurface(const glm::vec2& position) {
  const glm::vec2 cell = glm::floor(position / city::kPitch + 0.5f);
  const glm::vec2 q = position - cell * city::kPitch;  // from the nearest crossing
  const float half = city::kCarriageway * 0.5f;
  const float grain = valueNoise(position.x * 11.0f, position.y * 11.0f, 21).value;
  const float wear = valueNoise(position.x * 0.25f, position.y * 0.25f, 22).value;
  Surface surface{glm::vec3(0.36f, 0.36f, 0.37f) * (0.78f + 0.25f * grain + 0.2f * wear), 0.15f, 0.0f, asprs::kRoad};
  const bool inX = std::abs(q.x) < half, inY = std::abs(q.y) < half;  // on the street along y, along x
  if (inX == inY) {                                                   // the crossing itself
    const float lid = glm::distance(q, glm::vec2(1.4f, 1.1f));
    if (lid < 0.42f) surface.albedo *= lid < 0.36f ? 0.62f : 0.4f;
    return surface;
  }
  const float across = inX ? q.x : q.y, along = std::abs(inX ? q.y : q.x);
  const bool zebra = along > half + 0.6f && along < half + 3.6f && std::fmod(across + half, 1.0f) < 0.5f &&
                     std::abs(across) < half - 0.3f;
  const bool stop = along > half + 4.4f && along < half + 4.8f && std::abs(across) < half - 0.25f &&
                    (across > 0.0f) == ((inX ? q.y : -q.x) < 0.0f);
  const bool middle = along > half + 5.5f && std::abs(across) < 0.07f && std::fmod(along, 4.0f) < 2.4f;
  const bool edge = along > half + 5.5f && std::abs(std::abs(across) - (half - 2.1f)) < 0.05f &&
                    std::fmod(along, 5.5f) < 5.2f;  // parking bays
  if ((zebra || stop || middle || edge) && grain > 0.12f)
    surface = {glm::vec3(0.86f, 0.86f, 0.83f) * (0.85f + 0.15f * wear), 0.8f, 0.0f, asprs::kRoad};
  if (half - std::abs(across) < 0.3f) surface.albedo *= 0.85f;  // gutter
  return surface;
}

}  // namespace strata::synthetic
