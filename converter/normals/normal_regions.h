#pragma once
#include <cstdint>
#include <vector>

#include "converter/normals/add_normals.h"
#include "core/octahedral.h"
#include "io/store/store.h"

namespace strata {

/// Points of one node, by index in it.
struct RegionPoint {
  std::uint32_t node, point;
};

/// A cell of the octree.
struct NormalRegion {
  NodeKey cell;
  bool hasNode = false;  ///< else only points of the nodes above it lie there, and mostly none
};

/// Cells that cover every point of the store once, none with more than `limit` points below it where that can be had.
std::vector<NormalRegion> normalRegions(const Hierarchy& hierarchy, std::uint64_t limit);

/// How far a neighbour may be, metres: so that typical points have far more than they need within it, and the same
/// however the store is cut up. Reads every node.
double neighbourReach(const Store& store, const ConvertOptions& options, const ConvertControl& control);

/// The points in a region, wherever in the tree they are stored, and the normal of each.
struct RegionNormals {
  std::vector<RegionPoint> points;
  std::vector<Octahedral> normals;
};
/// `mostAround` limits the points around the region that are looked at: where there are more, `reach` is halved until
/// they fit.
RegionNormals estimateRegion(const Store& store, const NormalRegion& region, double reach, std::uint64_t mostAround,
                             const Viewpoint& viewpoint);

}  // namespace strata
