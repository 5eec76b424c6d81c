#pragma once
#include <string>

#include "viewer/camera/camera_path.h"
#include "viewer/camera/scan_sample.h"

namespace strata {

/// Makes a path that suits the scan: "orbit" goes around all of it, "flythrough" along it above its roofs, "dive" from
/// far above to single points, and "street" at a walker's height where the ground is free. Throws UsageError for
/// another name.
CameraPath makePath(const std::string& kind, const ScanSample& scan, const Store& store);

// The paths that need no store.
CameraPath orbitPath(const ScanSample& scan);
CameraPath flythroughPath(const ScanSample& scan);
CameraPath streetPath(const ScanSample& scan);

}  // namespace strata
