#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "io/store/store.h"

namespace strata {

struct VerifyReport {
  std::uint64_t checkedNodes = 0;
  std::uint64_t points = 0;           ///< in the sound nodes
  std::vector<std::string> problems;  ///< one line for each bad node, or for the store as a whole
  std::uint64_t badNodes = 0;
};

/// Reads every byte of an open store: checksums, counts, points inside their node's cube and contour, payloads
/// without gaps. (Opening it has checked store.json and hierarchy.bin.)
VerifyReport verifyStore(const Store& store);

}  // namespace strata
