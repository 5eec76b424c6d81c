#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "core/picture.h"
#include "core/render_list.h"
#include "render/thread_pool.h"

namespace strata {

/// Between neighbours whose seeds are next to each other: less can only be the picture's pixels.
inline constexpr float kFloodNextPixels = 4.0f;

/// How holes are filled; the defaults are what DrawOptions::jumpFlood does. faithfulFlood() is the paper's way.
struct FloodSettings {
  float reachSpacings = 4.0f;   ///< largest distance of two points of a layer, in spacings of their nodes
  float reachMetres = 0.0f;     ///< ... or the same for all points, where it is more than 0 (Farias 2014, 4.2)
  float angle = 0.5f;           ///< least |cosine| between the normals of a layer
  float continuity = 0.5f;      ///< farthest off the other's plane, a share of the largest distance
  int firstStep = 64;           ///< pixels of the seeds' picture: the longest jump
  float relativeRadius = 6.0f;  ///< largest radius, in distances of the closest neighbour
  bool sectors = true;          ///< the closest neighbour in each eighth of the circle; else the 4 closest of all
  bool estimateNormals = true;  ///< where points have none: the plane through the neighbours; else they face the eye
  bool useNormals = true;       ///< of the scan, where it has them
  bool ellipses = true;         ///< as the neighbours lie; else circles
  bool keepFront = true;        ///< what no splat hides keeps its colour; else all is blended
};

/// A pixel of the whole picture as x | y << 16: what seeds are called by. Smaller is higher up, then farther left.
using FloodPixel = std::uint32_t;
inline constexpr FloodPixel kNoPixel = 0xffffffffu;
inline constexpr int kFloodLargestSide = 0x7ffe;  ///< pixels; larger pictures stay as they are
constexpr FloodPixel floodPixel(std::uint32_t x, std::uint32_t y) { return y << 16 | x; }
constexpr int pixelColumn(FloodPixel pixel) { return static_cast<int>(pixel & 0xffffu); }
constexpr int pixelRow(FloodPixel pixel) { return static_cast<int>(pixel >> 16); }

/// From pixels of the whole picture and depths to metres from the eye: to the right, up, ahead.
struct FloodLens {
  bool perspective = true;
  float perPixel = 1.0f;  ///< metres, at depth 1 or at any
  float middleX = 0.0f, middleY = 0.0f;

  float metres(float depth) const { return perPixel * (perspective ? depth : 1.0f); }  ///< that a pixel covers
  glm::vec3 position(FloodPixel pixel, float depth) const {
    const float size = metres(depth);
    return {(static_cast<float>(pixelColumn(pixel)) + 0.5f - middleX) * size,
            (middleY - static_cast<float>(pixelRow(pixel)) - 0.5f) * size, depth};
  }
};
FloodLens floodLens(const View& view);

/// What of the point that a pixel of the half picture shows.
struct FloodPoint {
  float depth;
  float reach;  ///< metres; largest distance of a neighbour
};

/// A unit vector as x | y << 10 | z << 20, each 512 + 511 times the coordinate; 0 for the zero vector. And back.
std::uint32_t packFloodNormal(const glm::vec3& normal);
glm::vec3 unpackFloodNormal(std::uint32_t packed);

/// The first of the four steps (Farias 2014, 4.1): the nearest point of each 2 x 2 pixels, in the middle of its pixel.
struct FloodSeeds {
  int width = 0, height = 0;           ///< of the half picture
  FloodLens lens;                      ///< of the whole one
  std::vector<FloodPixel> at;          ///< for each pixel of the half picture where its seed is; kNoPixel: it has none
  std::vector<FloodPoint> points;      ///< by index()
  std::vector<std::uint32_t> normals;  ///< likewise, see packFloodNormal(), as positions are; 0: not known. Or empty

  std::size_t index(FloodPixel seed) const {
    return static_cast<std::size_t>(seed >> 17) * static_cast<std::size_t>(width) + ((seed & 0xffffu) >> 1);
  }
  glm::vec3 position(FloodPixel seed) const { return lens.position(seed, points[index(seed)].depth); }
  /// Largest distance of a neighbour, in pixels of the half picture.
  float reachPx(std::size_t i) const { return 0.5f * points[i].reach / lens.metres(points[i].depth); }
};

/// `picture` was drawn from the list, seen by `view`.
FloodSeeds collectSeeds(const RenderList& list, const View& view, const FloodSettings& settings, const Picture& picture,
                        const ThreadPool& pool);

/// Metres between the first `drawn` points of a node: its own spacing, or that of points spread evenly over the two
/// longer sides of its box where it is not known; more where not all are drawn.
float drawnSpacing(const NodeData& node, std::uint32_t drawn);

/// For each item of the list the largest distance of a neighbour of its points.
std::vector<float> floodReaches(const RenderList& list, const FloodSettings& settings);

}  // namespace strata
