#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "converter/control.h"
#include "converter/options.h"
#include "core/octahedral.h"
#include "io/store/store.h"

namespace strata {

/// A point of a store.
struct RegionPoint {
  std::uint32_t node, point;  ///< index of the node in the hierarchy, and of the point in the node
};

/// A cell whose points get their normals together.
struct NormalRegion {
  NodeKey cell;
  bool hasNode = false;  ///< otherwise only points of the nodes above lie in the cell, and mostly none
};

/// Returns cells that cover every point of the store once, none with more than `limit` points below it where the nodes
/// allow that.
std::vector<NormalRegion> normalRegions(const Hierarchy& hierarchy, std::uint64_t limit);

/// Returns how far a neighbour may be, metres: typical points have far more neighbours within it than they need, and it
/// is the same however the store is cut into nodes. Reads every node. Throws Error and Stopped.
double neighbourReach(const Store& store, const ConvertOptions& options, const ConvertControl& control);

/// The points in a region, wherever in the tree they are stored, and the normal of each.
struct RegionNormals {
  std::vector<RegionPoint> points;  ///< all points of a node follow one another
  std::vector<Octahedral> normals;
};
/// Normals look at `station` (world), or up where there is none. Where more than `mostAround` points lie around the
/// region, `reach` is halved until fewer do. Throws Error.
RegionNormals estimateRegion(const Store& store, const NormalRegion& region, double reach, std::uint64_t mostAround,
                             const std::optional<glm::dvec3>& station);

}  // namespace strata
