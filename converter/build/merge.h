#pragma once
#include <vector>

#include "converter/build/node_sink.h"
#include "converter/journal/spill.h"
#include "converter/options.h"

namespace strata {

/// The top node of a finished chunk, waiting for its ancestors.
struct ChunkTop {
  NodeKey key;
  Spill::Handle points;  ///< as BuiltChunk has them
  std::vector<SubtreeShape> children;
};

/// Builds the nodes above the chunks, bottom up (design section 5, stage 4): each takes an even share of its
/// children's own points by the same rule that chunks use; what remains of a child is then final and written.
/// `tops` are disjoint, in Morton order. Cells of a few chunks are merged side by side on `threads` threads, which
/// leaves fewer tops in the spill, and so on up to the root; the order in the file depends on the tops alone. In memory
/// at any time: the nodes of cells with `pointsAtOnce` points in their tops, or of one cell.
void mergeChunks(const BuildFrame& frame, std::vector<ChunkTop> tops, std::uint64_t pointsAtOnce, int threads,
                 Spill& spill, NodeSink& sink, const ConvertControl& control);

}  // namespace strata
