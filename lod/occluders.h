#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "core/box.h"
#include "core/node_data.h"

namespace strata {

/// A closed piece of a flat surface inside one of a node's cells, or inside several side by side.
struct Occluder {
  static constexpr std::size_t kMaxCorners = 6;

  std::array<glm::vec3, kMaxCorners> corner;  ///< convex, in order; metres from OccluderSet::origin
  std::uint32_t corners = 0;
  glm::vec3 normal{0.0f};
  float offset = 0.0f;  ///< dot(normal, corner)
  float back = 0.0f;    ///< metres from the surface to the far side of its points, and half a gap more
  float gap = 0.0f;     ///< metres: every square with this side on the surface holds a point
  bool whole = false;   ///< no node below has points here, so no later point can show a hole
};

/// The occluders of a node, found in its points when it is loaded.
struct OccluderSet {
  static constexpr int kCells = 8;  ///< cells along each axis of a node's cube; 4 for a node of few points
  static constexpr std::uint32_t kLeastPoints = 16;  ///< a cell with fewer points is not looked at
  static constexpr std::size_t kMost = 512;          ///< most occluders of a node
  /// The most occluders of a node with so many points; others are left out.
  static std::size_t mostOf(std::uint64_t points) { return std::min<std::uint64_t>(kMost, points / 32); }

  glm::dvec3 origin{0.0};  ///< the middle of the node's cube in world coordinates
  double cellSide = 0.0;   ///< metres
  std::vector<Occluder> occluders;
};

/// Finds pieces of surface that are known to have no hole. A contour does not do (as in Kanzok 2015, 3.2.2): it is only
/// a bound, a facade has windows, and a room is empty inside. So the node's cube is cut into 8 x 8 x 8 cells, fewer for
/// few points. A plane is fitted to the points of each cell, across their smallest principal axis. The face of the cell
/// that the plane faces most is cut into 16 x 16 squares. When every square that the plane crosses inside the cell
/// holds a point near the plane, the plane's part in the cell is an occluder; else 8 x 8 and 4 x 4 squares are tried.
/// Pieces of one wall in neighbouring cells share their edges.
///
/// `cube` is the node's cube and `childMask` its record's. Uses the leading 10 bits of the positions. Replaces `out`.
void findOccluders(const NodeData& node, const Box& cube, std::uint8_t childMask, OccluderSet& out);

}  // namespace strata
