#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "io/store/node_codec.h"
#include "io/store/node_payload.h"

namespace strata {

/// Sorts the points of every level by Morton key: the stored order.
struct PointOrder {
  std::vector<std::uint32_t> index;  ///< into the points; points of equal key stand as they came
  std::vector<std::uint32_t> keys;   ///< of the points in stored order; 30 bits
  std::vector<std::uint64_t> pairs, spare;
};
void sortLevels(const NodePoints& points, const PayloadHead& head, std::span<const std::uint32_t> levelEnds,
                PointOrder& out);

}  // namespace strata
