#pragma once
#include <cstdint>

#include "converter/distribute/packed_points.h"
#include "converter/options.h"

namespace strata {

/// Returns the largest number of points of a chunk for which building stays within `options.memoryBytes`. `points` is
/// the size of the scan. Throws Error when there is too little memory.
std::uint64_t chunkPointLimit(const ConvertOptions& options, const PackedFormat& format, std::uint64_t points);

/// Returns how many points may be in memory at the same time when no chunk has more than `chunkLimit`.
std::uint64_t pointsAtOnce(std::uint64_t chunkLimit);

}  // namespace strata
