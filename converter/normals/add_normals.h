#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>

#include "converter/control.h"
#include "converter/options.h"
#include "io/store/store.h"

namespace strata {

/// True when normals are asked for and the scan has none. Warns where it has some.
bool normalsMissing(const StoreInfo& info, const ConvertOptions& options, const ConvertControl& control);

/// Nodes that are to get normals.
struct NormalsJob {
  const std::string& pointsPath;      ///< the nodes as they are
  const std::string& newPath;         ///< the nodes with normals, to be written
  std::optional<glm::dvec3> station;  ///< the place that normals look at, world; empty = they look up
  const ConvertOptions& options;
  const ConvertControl& control;
};

/// Gives every point of the nodes in `job.pointsPath` a normal: that of the plane through its nearest neighbours,
/// wherever in the scan these are stored. The neighbours depend on the points alone, not on nodes, chunks or threads
/// (docs/decisions/0015-neighbours-of-our-own.md). Normals are estimated region by region of at most some hundred
/// thousand points, each read with what lies around it. Then the nodes are written to `job.newPath` with the attribute
/// kNormalOctahedral added, and `info` and `hierarchy` are made to fit. Returns the most temporary bytes held, without
/// those of `job.newPath`. Throws Error and Stopped.
std::uint64_t addNormals(const NormalsJob& job, StoreInfo& info, Hierarchy& hierarchy);

}  // namespace strata
