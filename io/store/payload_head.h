#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "io/store/node_payload.h"
#include "io/store/store.h"

namespace strata {

/// Head, levels and directory of a node's payload, checked against each other and against the record.
struct ParsedHead {
  PayloadHead head;
  std::vector<std::uint32_t> levelEnds;
  std::vector<PayloadPlane> planes;
};

/// `payload` starts with the head; more may follow. Throws Error (`points.bin: node r042: ...`) for what does not fit.
ParsedHead parseHead(const NodeRecord& record, std::span<const std::byte> payload);

}  // namespace strata
