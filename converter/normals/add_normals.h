#pragma once
#include <optional>
#include <string>

#include "converter/options.h"
#include "io/store/store.h"

namespace strata {

/// Where the scanner stood, world; normals look there, or upwards where it is not known.
using Viewpoint = std::optional<glm::dvec3>;
/// Of a single PCD file that says so. Several scans have several, and their points do not say whose they are.
Viewpoint viewpointOf(const std::vector<std::unique_ptr<PointSource>>& sources);

/// Whether normals have to be estimated: asked for, and not there. Warns where they are.
bool normalsMissing(const StoreInfo& info, const ConvertOptions& options, const ConvertControl& control);

/// Gives every point of the nodes in `pointsPath` a normal: that of the plane through its nearest neighbours, wherever
/// in the scan these are stored. Which neighbours count depends on the points alone, not on nodes, chunks or threads.
/// Region by region of at most some hundred thousand points, each read with what lies around it. Then the nodes are
/// written anew to `newPath` with the attribute kNormalOctahedral added; `info` and `hierarchy` are made to fit.
/// Returns the most temporary bytes held, those of `newPath` not counted. Throws Error.
std::uint64_t addNormals(StoreInfo& info, Hierarchy& hierarchy, const std::string& pointsPath,
                         const std::string& newPath, const Viewpoint& viewpoint, const ConvertOptions& options,
                         const ConvertControl& control);

}  // namespace strata
