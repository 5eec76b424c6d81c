#pragma once
#include <vector>

#include "converter/build/build_context.h"
#include "converter/build/node_sink.h"
#include "converter/journal/conversion.h"

namespace strata {

/// Builds the nodes above the chunks, bottom up: each takes an even share of its children's own points by the same rule
/// that chunks use, and the rest of a child is then final and written. `tops` are disjoint and in Morton order. Cells
/// with a few tops are merged side by side on `options.threads` threads, which leaves fewer tops in the spill, and so
/// on up to the root; the order in the file depends on the tops alone. In memory at any time: the nodes of cells with
/// `context.pointsAtOnce` points in their tops, or of one cell. Throws Error and Stopped.
void mergeChunks(const Conversion& conversion, const BuildContext& context, std::vector<ChunkTop> tops, NodeSink& sink);

}  // namespace strata
