#pragma once
#include "converter/build/merge.h"
#include "converter/distribute/distribute.h"

namespace strata {

/// What the journal keeps of a finished chunk.
struct ChunkRecord {
  std::uint64_t index = 0;  ///< of its bucket
  NodeSink::Written written;
  ChunkTop top;
};
void appendChunk(Journal& journal, const ChunkRecord& chunk);
/// All that the journal found, in order.
std::vector<ChunkRecord> readChunks(const Journal& journal);
/// Where the points of a chunk's top node wait; of one record.
Spill::Handle readChunkTop(const Journal& journal, const Journal::Place& place);

/// Builds the chunks of all buckets, as many at a time as there are threads and have `pointsAtOnce` points together or
/// one more, and writes them in order, behind those that `found` has of an interrupted conversion.
std::vector<ChunkTop> buildChunks(const BuildFrame& frame, const Distribution& all, std::vector<ChunkRecord> found,
                                  std::uint64_t pointsAtOnce, const ConvertOptions& options, Workspace work,
                                  NodeSink& sink, const ConvertControl& control);

}  // namespace strata
