#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <glm/gtc/type_precision.hpp>
#include <vector>

#include "core/node_key.h"

namespace strata {

/// Consecutive points of one node and a box around them; one work group draws one batch (Schütz 2022, 3.1). All batches
/// of a node out of a store share the node's box, because each holds points from everywhere in it.
struct Batch {
  static constexpr std::uint32_t kMaxPoints = 10240;

  std::uint32_t firstPoint = 0;  ///< within the node
  std::uint32_t pointCount = 0;
  glm::dvec3 boxMin{0.0};   ///< relative to NodeData::origin; a multiple of the store's grid step
  glm::dvec3 boxSize{0.0};  ///< 2^bits grid steps along each axis: what the 30-bit coordinates span
  glm::u8vec3 bits{0};      ///< bits that carry information along each axis; those beyond 30 are not drawn
};

/// How many of a coordinate's 30 bits are used: 10, 20 or 30 (Schütz 2022, 3.3).
enum class Precision : std::uint8_t { low10 = 1, medium20 = 2, full30 = 3 };

/// The number of pixels that a batch or node may span before 10 bits, or 20, are too coarse for it (Schütz 2022, 3.3).
/// Coordinates span a power of two of grid steps, up to twice the box of the points, so a step of theirs is at most one
/// pixel wide and the error half a pixel.
inline constexpr double kPixelsAt10Bits = 500.0;
inline constexpr double kPixelsAt20Bits = kPixelsAt10Bits * 1024.0;

/// One node as rasterizers read it: decoded planes, as a struct of arrays. Immutable once it has left the decoder.
/// With p = 1, 2 or 3 planes, the position of point i of batch b along an axis is
///   X = position[0]>>axis*10 &1023, then the same of position[1], position[2]: 10*p bits, most significant first
///   x = origin + boxMin + (X + h) * boxSize / 2^(10p),  h = 0.5 when the batch has more bits than 10p, else 0
/// (Schütz 2022 eq. 1 over a box of 2^bits grid steps instead of the tight one, so that 30 bits give back the
/// source's integer exactly).
struct NodeData {
  NodeKey key;
  glm::dvec3 origin{0.0};                    ///< world coordinates
  float spacing = 0.0f;                      ///< metres between neighbours when all points are drawn; 0 when unknown
  std::vector<Batch> batches;                ///< by ascending firstPoint; they cover all points
  std::vector<std::uint32_t> position[3];    ///< x | y<<10 | z<<20; [1] and [2] are empty when not loaded
  std::vector<std::uint32_t> colour;         ///< R | G<<8 | B<<16 | 255<<24; empty when the store has none
  std::vector<std::uint16_t> intensity;      ///< empty when the store has none
  std::vector<std::uint8_t> classification;  ///< empty when the store has none
  std::vector<std::uint8_t> returnNumber;    ///< empty when the store has none or it was not asked for
  std::vector<std::uint32_t> normal;         ///< as packNormal() packs them; empty likewise

  std::uint32_t pointCount() const { return static_cast<std::uint32_t>(position[0].size()); }
  int loadedPlanes() const { return position[1].empty() ? 1 : position[2].empty() ? 2 : 3; }
  std::uint64_t bytes() const;  ///< bytes of memory held
};

/// Packs the direction of a vector of any length as x | y<<8 | z<<16, signed bytes with 127 for 1. Returns 0 for a
/// vector that is zero or not finite.
std::uint32_t packNormal(const glm::vec3& normal);

/// The position of one point in world coordinates, where every rasterizer must place it.
glm::dvec3 pointPosition(const NodeData& node, const Batch& batch, std::uint32_t point, Precision precision);

}  // namespace strata
