#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "io/store/node_payload.h"
#include "io/store/store.h"

namespace strata {

/// The head of a node's payload with its levels and its directory of planes, checked against each other and against the
/// record.
struct ParsedHead {
  PayloadHead head;
  std::vector<std::uint32_t> levelEnds;
  std::vector<PayloadPlane> planes;
};

/// Decodes the head at the start of `payload`. Throws Error (`points.bin: node r042: ...`) when it does not fit.
ParsedHead parseHead(const NodeRecord& record, std::span<const std::byte> payload);

}  // namespace strata
