#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "io/store/node_codec.h"
#include "io/store/node_payload.h"

namespace strata {

/// The stored order of the points: those of every level are sorted by Morton key.
struct PointOrder {
  std::vector<std::uint32_t> index;         ///< of the points in stored order; equal keys keep their order
  std::vector<std::uint32_t> keys;          ///< of the points in stored order, 30 bits each
  std::vector<std::uint64_t> pairs, spare;  ///< working memory
};
/// Replaces `out`. `levelEnds` are the ends of the levels, the last of them points.count().
void sortLevels(const NodePoints& points, const PayloadHead& head, std::span<const std::uint32_t> levelEnds,
                PointOrder& out);

}  // namespace strata
