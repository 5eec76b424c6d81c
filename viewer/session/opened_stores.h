#pragma once
#include <memory>
#include <string>
#include <vector>

#include "io/store/store.h"
#include "viewer/camera/scan_sample.h"

namespace strata {

/// What of the stores could be opened, and what could not.
struct OpenedStores {
  std::vector<std::shared_ptr<const Store>> stores;
  std::vector<std::size_t> asked;  ///< which of the paths asked for each is
  std::string failures;            ///< a line for each that could not be opened
};

/// Opens what can be opened. Throws Error where that is nothing.
OpenedStores openStores(const std::vector<std::string>& paths);

/// A sample of all stores together. A store with damaged nodes is represented by the corners of its bounds.
ScanSample sampleStores(const std::vector<std::shared_ptr<const Store>>& stores);

/// "scan" of "/data/scan.strata"; of several with commas between.
std::string layerNames(const std::vector<std::string>& paths);

/// A name that a user gave, without what has no place in a file's.
std::string fileNameOf(std::string name);

}  // namespace strata
