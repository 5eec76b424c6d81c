#pragma once
#include <memory>
#include <string>
#include <vector>

#include "io/scan/point_source.h"

namespace strata {

/// Disk that a conversion needs, bytes.
struct DiskNeed {
  double store = 0.0;
  double temporary = 0.0;  ///< most at a time
};

/// What scans like these usually need, from counts and record sizes alone; planConversion() looks closer.
DiskNeed usualDiskNeed(const std::vector<std::unique_ptr<PointSource>>& sources);

/// A sentence for each disk that has less room than is needed on it. `storeFolder` is where the store will stand,
/// `tempFolder` where the temporary points will; both may be on one disk. Nothing where the system does not say.
std::vector<std::string> roomWarnings(const std::string& storeFolder, const std::string& tempFolder,
                                      const DiskNeed& need);

/// The folder that holds `path`; "." where none is named.
std::string folderOf(const std::string& path);

/// "512 MiB", "13.4 GiB".
std::string bytesText(double bytes);

}  // namespace strata
