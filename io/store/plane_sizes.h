#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "io/store/store.h"

namespace strata {

/// What one plane of all nodes takes on disk.
struct PlaneSize {
  std::string name;         ///< "position 10", "colour", ... or the attribute's name; "heads" for what describes planes
  std::uint64_t bytes = 0;  ///< stored
  std::uint64_t rawBytes = 0;  ///< what the same values take unpacked: whole bytes, each coordinate its bits in the
                               ///< node's bounds; 0 for heads
};

/// Sums over all nodes, in the order of the payload: bytes of points.bin by plane, nothing left out but its header.
/// Reads the heads of all nodes (some hundred bytes each); throws Error where one is damaged.
std::vector<PlaneSize> planeSizes(const Store& store);

/// One line a plane: name, bytes a point stored and raw. For strata-info and the converter's summary.
std::string planeSizesText(const std::vector<PlaneSize>& planes, std::uint64_t points);

}  // namespace strata
