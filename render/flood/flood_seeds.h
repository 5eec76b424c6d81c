#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "core/picture.h"
#include "core/render_list.h"
#include "render/thread_pool.h"

namespace strata {

/// Pixels of the picture. Two seeds in neighbouring pixels of the half picture may lie so far apart on one surface.
inline constexpr float kFloodNextPixels = 4.0f;

/// How holes are filled. Everybody draws with the defaults. tests/bench/fill_quality.cpp measures what each deviation
/// from the paper brings, so the kernels keep the paper's way next to ours.
struct FloodSettings {
  float reachSpacings = 4.0f;   ///< largest distance of two points of a layer, in spacings of their nodes
  float reachMetres = 0.0f;     ///< if more than 0: that distance for all points (Farias 2014, 4.2)
  float angle = 0.5f;           ///< least |cosine| between two normals of a layer
  float continuity = 0.5f;      ///< farthest off each other's plane, as a share of the largest distance
  int firstStep = 64;           ///< longest jump, pixels of the half picture
  float relativeRadius = 6.0f;  ///< largest radius, in distances of the closest neighbour
  bool sectors = true;          ///< take the closest neighbour in each eighth of the circle; else the 4 closest
  bool estimateNormals =
      true;  ///< points without a normal get that of the plane through their neighbours; else they face the eye
  bool useNormals = true;  ///< take the scan's normals, where it has them
  bool ellipses = true;    ///< splats are ellipses that follow the neighbours; else circles
  bool keepFront = true;   ///< points that no splat hides keep their colour; else all are blended
};

/// A pixel of the whole picture as x | y << 16, which identifies a seed. Smaller values lie higher up, then farther
/// left.
using FloodPixel = std::uint32_t;
inline constexpr FloodPixel kNoPixel = 0xffffffffu;
inline constexpr int kFloodLargestSide = 0x7ffe;  ///< pixels; larger pictures stay as they are
constexpr FloodPixel floodPixel(std::uint32_t x, std::uint32_t y) { return y << 16 | x; }
constexpr int pixelColumn(FloodPixel pixel) { return static_cast<int>(pixel & 0xffffu); }
constexpr int pixelRow(FloodPixel pixel) { return static_cast<int>(pixel >> 16); }

/// Turns pixels of the whole picture and depths into positions relative to the eye: metres to the right, up and ahead.
struct FloodLens {
  bool perspective = true;
  float perPixel = 1.0f;                 ///< metres that a pixel covers at depth 1 (perspective) or at any depth
  float middleX = 0.0f, middleY = 0.0f;  ///< where the view's axis meets the picture, pixels

  float metres(float depth) const { return perPixel * (perspective ? depth : 1.0f); }  ///< size of a pixel at `depth`
  glm::vec3 position(FloodPixel pixel, float depth) const {
    const float size = metres(depth);
    return {(static_cast<float>(pixelColumn(pixel)) + 0.5f - middleX) * size,
            (middleY - static_cast<float>(pixelRow(pixel)) - 0.5f) * size, depth};
  }
};
FloodLens floodLens(const View& view);

/// The point that a pixel of the half picture shows.
struct FloodPoint {
  float depth;
  float reach;  ///< largest distance of a neighbour, metres
};

/// Packs a unit vector as x | y << 10 | z << 20, where each part is 512 + 511 times the coordinate; 0 for the zero
/// vector.
std::uint32_t packFloodNormal(const glm::vec3& normal);
glm::vec3 unpackFloodNormal(std::uint32_t packed);

/// The result of the first of the four steps (Farias 2014, 4.1): the half picture, each of whose pixels has as its seed
/// the nearest point of 2 x 2 pixels of the whole picture. A seed lies in the middle of its pixel of the whole picture.
struct FloodSeeds {
  int width = 0, height = 0;       ///< of the half picture
  FloodLens lens;                  ///< of the whole picture
  std::vector<FloodPixel> at;      ///< by index(): the seed's pixel of the whole picture; kNoPixel: no seed
  std::vector<FloodPoint> points;  ///< by index()
  std::vector<std::uint32_t>
      normals;  ///< by index(), in the axes of FloodLens, packed; 0: not known. Empty where none is known

  /// The index of the half picture's pixel that `seed` belongs to.
  std::size_t index(FloodPixel seed) const {
    return static_cast<std::size_t>(seed >> 17) * static_cast<std::size_t>(width) + ((seed & 0xffffu) >> 1);
  }
  glm::vec3 position(FloodPixel seed) const { return lens.position(seed, points[index(seed)].depth); }
  /// The largest distance of a neighbour, in pixels of the half picture.
  float reachPx(std::size_t i) const { return 0.5f * points[i].reach / lens.metres(points[i].depth); }
};

/// Collects the seeds of `picture`, which was drawn from `list` as seen by `view`. A picture larger than
/// kFloodLargestSide has none.
FloodSeeds collectSeeds(const RenderList& list, const View& view, const FloodSettings& settings, const Picture& picture,
                        const ThreadPool& pool);

/// The distance between neighbours among the first `drawn` points of a node, metres. It follows from the node's
/// spacing, or, where that is not known, from points spread evenly over the two longer sides of its box.
float drawnSpacing(const NodeData& node, std::uint32_t drawn);

/// The largest distance of a neighbour for the points of each item of the list, metres.
std::vector<float> floodReaches(const RenderList& list, const FloodSettings& settings);

}  // namespace strata
