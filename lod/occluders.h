#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "core/box.h"
#include "core/node_data.h"

namespace strata {

/// A closed piece of a flat surface: the part of a plane that lies inside one of a node's cells.
struct Occluder {
  static constexpr std::size_t kMaxCorners = 6;

  std::array<glm::vec3, kMaxCorners> corner;  ///< convex, in order; metres from OccluderSet::origin
  std::uint32_t corners = 0;
  glm::vec3 normal{0.0f};
  float offset = 0.0f;  ///< dot(normal, corner)
  float back = 0.0f;    ///< metres from the plane to the far side of its points, with a margin of half a gap
  float gap = 0.0f;     ///< every square of this side on the surface holds a point, metres
  bool whole = false;   ///< no node below has points here, so the gaps are known to be those of the scan
};

/// What of a node hides things behind it, found from its points when it is loaded.
struct OccluderSet {
  static constexpr int kCells = 8;                   ///< of a node's cube, along each axis; 4 where it has few points
  static constexpr std::uint32_t kLeastPoints = 16;  ///< of a cell that is looked at; no occluder has fewer
  static constexpr std::size_t kMost = 512;          ///< occluders of a node
  /// Occluders of a node with so many points; what is found beyond is left out.
  static std::size_t mostOf(std::uint64_t points) { return std::min<std::uint64_t>(kMost, points / 32); }

  glm::dvec3 origin{0.0};  ///< world: the middle of the node's cube
  double cellSide = 0.0;   ///< metres
  std::vector<Occluder> occluders;
};

/// A contour is a bound, and what is inside it may be full of holes: a facade has windows, a room's box is empty. So
/// occluders are not contours (as in Kanzok 2015, 3.2.2) but pieces of them that are known to be covered: the node's
/// cube is cut into 8 x 8 x 8 cells (fewer for few points); a plane is fitted to the points of each (smallest principal
/// axis); the cell's side that faces the plane most is cut into 16 x 16 squares, and where every square that the plane
/// crosses inside the cell holds a point near the plane (else every one of 8 x 8 or 4 x 4), the plane's part in the
/// cell is an occluder. Pieces of one wall in neighbouring cells share their edges.
///
/// `cube` is the node's, `childMask` that of its record. Uses the leading 10 bits of the positions. `out` is replaced.
void findOccluders(const NodeData& node, const Box& cube, std::uint8_t childMask, OccluderSet& out);

}  // namespace strata
