#include "converter/build/chunk_limit.h"

#include <algorithm>
#include <string>

#include "converter/build/chunk_builder.h"
#include "core/error.h"

namespace strata {
namespace {

/// Four of the largest chunks, or more smaller ones, are built at the same time and share the memory. The number is
/// fixed so that the chunks, and with them the store's bytes, do not depend on the number of threads.
constexpr int kChunksAtOnce = 4;
/// No chunk is larger, however much memory there is, because stopping waits for the chunks that are being built.
constexpr std::uint64_t kMostChunkPoints = 3'000'000;
/// With chunks of fewer points the tree above them would outweigh them.
constexpr std::uint64_t kLeastChunkPoints = 20'000;
constexpr std::uint64_t kProgramBytes = std::uint64_t{160} << 20;
constexpr std::uint64_t kRunBytes = 2048;  // cursor of a run, which has about a million points

}  // namespace

std::uint64_t chunkPointLimit(const ConvertOptions& options, const PackedFormat& format, std::uint64_t points) {
  // What grows with the scan comes first: the hierarchy's records, twice while their vector grows, and the runs.
  const std::uint64_t nodes = 4 * points / options.nodePoints + 1;
  const std::uint64_t growing = 2 * sizeof(NodeRecord) * nodes + (points >> 20) * kRunBytes;
  // The rest is for chunks: the memory of building them, and finished nodes of a point's size per point.
  const std::uint64_t perPoint = 2 * kChunksAtOnce * (chunkBytesPerPoint(format) + format.stride());
  const std::uint64_t least = kProgramBytes + growing + kLeastChunkPoints * perPoint;
  if (options.memoryBytes < least)
    throw Error("--memory", "is too little for so many points in nodes of so few, found " +
                                std::to_string(options.memoryBytes >> 20) + "M (expected at least " +
                                std::to_string((least >> 20) + 1) + "M)");
  return std::min(kMostChunkPoints, (options.memoryBytes - kProgramBytes - growing) / perPoint);
}

std::uint64_t pointsAtOnce(std::uint64_t chunkLimit) { return (kChunksAtOnce - 1) * chunkLimit; }

}  // namespace strata
