#pragma once
#include <memory>
#include <string>

#include "io/scan/point_source.h"

namespace strata {

/// The points of a PCD file, all of them: those of organised clouds that are not finite come out as they are.
/// ascii and binary are streamed; binary_compressed has to be unpacked whole (see pcl_source.h).
/// VIEWPOINT says where the sensor stood; it is not applied to the points, which are in the world's frame already.
std::unique_ptr<PointSource> openPcd(const std::string& path, const SourceOptions& options);

/// Where the header says that the sensor stood, in the world; nothing where it does not say. Throws Error.
std::optional<glm::dvec3> pcdViewpoint(const std::string& path);

}  // namespace strata
