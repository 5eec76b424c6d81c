#pragma once
#include <cstdint>
#include <utility>
#include <vector>

#include "io/store/store.h"
#include "lod/depth_buffers.h"
#include "lod/fade.h"
#include "lod/failed_nodes.h"
#include "lod/hierarchy_index.h"
#include "lod/list_builder.h"
#include "lod/lod_task.h"
#include "lod/node_cache.h"
#include "lod/selection.h"
#include "lod/trace.h"

namespace strata {

/// The work of the LOD thread for one view: it draws the coarse depth, selects nodes, and splits them into those that
/// can be drawn and those to be loaded (Kanzok 2015, 3.2.2). One thread; keeps its memory for the next pass.
class LodPass {
 public:
  struct Result : ListBuilder::Result {
    std::uint32_t occluded = 0;   ///< nodes left out as hidden, with everything below them
    std::uint32_t occluders = 0;  ///< pieces of surface that could hide nodes
    std::uint32_t fading = 0;     ///< nodes drawn with fewer points than wanted for now; retryAt is then near
  };

  /// The arguments have to outlive the pass.
  LodPass(const Store& store, const HierarchyIndex& index, Precision leastPrecision, NodeCache& cache,
          DepthBuffers& depth);

  /// Fills `out.pinned`, which must be empty, and replaces `out.requests`. `lane` may be null.
  Result run(const LodTask& task, const FailedNodes& failed, Fade::Time now, LodOutput& out, TraceLane* lane);

 private:
  const CoarseDepth* fillCoarseDepth(const LodTask& task);

  // Constant after construction.
  const Store& store_;
  const HierarchyIndex& index_;
  NodeCache& cache_;
  DepthBuffers& depth_;

  // Used by the LOD thread.
  ListBuilder builder_;
  Fade fade_;
  Selection selection_, selectionAhead_;
  FailedNodes::ByNode failures_;
  std::uint64_t failuresVersion_ = 0;
  std::vector<NodeCache::Data> occluding_;
  std::vector<std::pair<double, const OccluderSet*>> bySize_;  ///< their occluders by apparent size
  std::vector<NodeCache::Pin> occludingPins_;
  std::vector<NodeCache::Released> released_;
};

}  // namespace strata
