#pragma once
#include <memory>
#include <string>

#include "io/scan/point_source.h"

namespace strata {

/// Opens a PCD file. All its points come out, also those of organised clouds that are not finite. Files that are ascii
/// or binary are streamed; binary_compressed ones have to be unpacked whole (compressed_pcd.h). The header's VIEWPOINT
/// becomes SourceInfo::viewpoint but is not applied to the points, whose coordinates are world coordinates already.
std::unique_ptr<PointSource> openPcd(const std::string& path, const SourceOptions& options);

}  // namespace strata
