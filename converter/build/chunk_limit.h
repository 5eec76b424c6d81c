#pragma once
#include <cstdint>

#include "converter/distribute/packed_points.h"
#include "converter/options.h"

namespace strata {

/// How many points a chunk may have so that everything that is in memory while chunks are built stays within
/// `options.memoryBytes`. `points` is the size of the scan. Throws Error where the memory is too little.
std::uint64_t chunkPointLimit(const ConvertOptions& options, const PackedFormat& format, std::uint64_t points);

/// How many points may be in memory together where chunks have at most `chunkLimit`.
std::uint64_t pointsAtOnce(std::uint64_t chunkLimit);

}  // namespace strata
