#pragma once
#include <memory>
#include <string>
#include <vector>

#include "io/store/store.h"
#include "viewer/camera/scan_sample.h"

namespace strata {

/// The stores that could be opened, and the reasons why others could not.
struct OpenedStores {
  std::vector<std::shared_ptr<const Store>> stores;
  std::vector<std::size_t> asked;  ///< for each store, the index of its path among those asked for
  std::string failures;            ///< a line for each path that could not be opened
};

/// Opens every store that can be opened. Throws Error when none can.
OpenedStores openStores(const std::vector<std::string>& paths);

/// A sample of all stores together. A store with damaged nodes is represented by the corners of its bounds.
ScanSample sampleStores(const std::vector<std::shared_ptr<const Store>>& stores);

/// The names of stores without folders and endings, separated by commas: "scan" for "/data/scan.strata".
std::string layerNames(const std::vector<std::string>& paths);

/// A name that a user gave, made fit for a file: characters that no file name may have become underscores.
std::string fileNameOf(std::string name);

}  // namespace strata
