#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "io/store/store.h"

namespace strata {

/// The bytes on disk of one plane of all nodes together.
struct PlaneSize {
  std::string name;  ///< "position 10", "colour", ... or the attribute's name; "heads" for the heads of the payloads
  std::uint64_t bytes = 0;     ///< stored
  std::uint64_t rawBytes = 0;  ///< of the same values unpacked: whole bytes, and for each coordinate its bits in
                               ///< the node's bounds; 0 for heads
};

/// Adds up the bytes of points.bin by plane, in the order of the payload. Only the header of the file is left out.
/// Reads the heads of all nodes, some hundred bytes each. Throws Error when one is damaged.
std::vector<PlaneSize> planeSizes(const Store& store);

/// The table that strata-info and the converter print: for each plane its name, and its stored and raw bytes per point.
std::string planeSizesText(const std::vector<PlaneSize>& planes, std::uint64_t points);

}  // namespace strata
