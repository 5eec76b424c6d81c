#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "io/store/store.h"

namespace strata {

struct VerifyReport {
  std::uint64_t checkedNodes = 0;
  std::uint64_t points = 0;           ///< in the undamaged nodes
  std::vector<std::string> problems;  ///< one line for each bad node, or for the store as a whole
  std::uint64_t badNodes = 0;
};

/// Reads every byte of points.bin, and checks the checksums, the counts, that every point lies in its node's cube and
/// contour, and that the payloads have no gaps. (store.json and hierarchy.bin were checked when the store was opened.)
VerifyReport verifyStore(const Store& store);

}  // namespace strata
