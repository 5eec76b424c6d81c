#pragma once
#include <string>
#include <vector>

#include "io/scan/point_source.h"

namespace strata {

/// The disk that a conversion needs, bytes.
struct DiskNeed {
  double store = 0.0;
  double temporary = 0.0;  ///< at its peak
};

/// Estimates what scans like these usually need, from counts and record sizes alone. planConversion() looks closer.
DiskNeed usualDiskNeed(const Sources& sources);

/// Returns a sentence for each disk that has less room than it needs. `storeFolder` is the folder of the store and
/// `tempFolder` that of the spill; both may be on one disk. Returns nothing where the system does not know.
std::vector<std::string> roomWarnings(const std::string& storeFolder, const std::string& tempFolder,
                                      const DiskNeed& need);

/// The folder that holds `path`; "." where `path` names none.
std::string folderOf(const std::string& path);

/// "512 MiB", "13.4 GiB".
std::string bytesText(double bytes);

}  // namespace strata
