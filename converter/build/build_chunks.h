#pragma once
#include <vector>

#include "converter/build/build_context.h"
#include "converter/build/node_sink.h"
#include "converter/distribute/chunks.h"
#include "converter/journal/conversion.h"

namespace strata {

/// Builds all chunks and writes their nodes in the order of the chunks, behind the chunks that `found` has of an
/// interrupted conversion. As many chunks are built at the same time as there are threads and `context.pointsAtOnce`
/// allows. Returns the tops of all chunks, in their order. Throws Error and Stopped.
std::vector<ChunkTop> buildChunks(const Conversion& conversion, const BuildContext& context, const Distribution& all,
                                  std::vector<ChunkRecord> found, NodeSink& sink);

}  // namespace strata
