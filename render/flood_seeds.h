#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "core/frame.h"
#include "core/render_list.h"
#include "render/thread_pool.h"

namespace strata {

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

/// Farias 2014 as printed: `scale` is the longest side of the model, `share` of it the largest distance (0.01 where the
/// points are dense to 0.1 where they are sparse), continuity 0.05 of it, circles around the 4 closest neighbours.
FloodSettings faithfulFlood(float scale, float share);

/// A point that a pixel of half the picture's resolution shows.
struct FloodSeed {
  glm::vec3 position;  ///< metres from the eye: to the right, up, ahead
  float reach;         ///< metres; largest distance of a neighbour
  glm::vec3 normal;    ///< in the same frame, towards the eye; 0 where there is none
  std::uint32_t from;  ///< pixel of the whole picture that it was found in
  float reachPx;       ///< the same in pixels of the half picture
  std::uint16_t x, y;  ///< pixel of the half picture
  float spacing;       ///< metres
};

/// The first of the four steps (Farias 2014, 4.1): the nearest point of each 2 x 2 pixels.
struct FloodSeeds {
  static constexpr std::uint32_t kNone = 0xffffffffu;

  int width = 0, height = 0;
  std::vector<FloodSeed> seeds;   ///< row by row
  std::vector<std::uint32_t> at;  ///< for each pixel the index of its seed, or kNone
};

/// `frame` was drawn from the list, seen by `view`.
FloodSeeds collectSeeds(const RenderList& list, const View& view, const FloodSettings& settings, const Frame& frame,
                        const ThreadPool& pool);

/// Metres between the first `drawn` points of a node: its own spacing, or that of points spread evenly over the two
/// longer sides of its box where it is not known; more where not all are drawn.
float drawnSpacing(const NodeData& node, std::uint32_t drawn);

}  // namespace strata
