#pragma once
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "core/view.h"
#include "io/store/store.h"
#include "lod/depth_buffers.h"
#include "lod/fade.h"
#include "lod/failed_nodes.h"
#include "lod/hierarchy_index.h"
#include "lod/list_builder.h"
#include "lod/load_queue.h"
#include "lod/node_cache.h"
#include "lod/selection.h"
#include "lod/trace.h"

namespace strata {

/// What an LOD pass works on.
struct LodTask {
  View view;
  std::optional<View> ahead;  ///< where the camera will soon be
  SelectionOptions selection;
  std::uint64_t generation = 0;  ///< counts what was asked for
};

/// What the LOD thread does for a view: finds out what hides what, selects, and splits the selection into what can be
/// drawn and what is to be loaded (Kanzok 2015, 3.2.2). One thread; keeps its scratch memory for the next pass.
class LodPass {
 public:
  struct Result : ListBuilder::Result {
    std::uint32_t occluded = 0;   ///< nodes left out, and all below them, as hidden
    std::uint32_t occluders = 0;  ///< pieces of surface behind which they were looked for
    std::uint32_t fading = 0;     ///< nodes drawn with fewer points than wanted, for now; retryAt is then soon
  };

  /// The arguments have to outlive it.
  LodPass(const Store& store, const HierarchyIndex& index, Precision leastPrecision, NodeCache& cache,
          DepthBuffers& depth);

  /// Fills `out`, which must be empty but for its memory, and replaces `requests`.
  Result run(const LodTask& task, const FailedNodes& failed, Fade::Time now, PinnedList& out,
             std::vector<LoadRequest>& requests, TraceLane* lane);

 private:
  const CoarseDepth* fillCoarseDepth(const LodTask& task);

  const Store& store_;
  const HierarchyIndex& index_;
  NodeCache& cache_;
  DepthBuffers& depth_;
  ListBuilder builder_;
  Fade fade_;
  Selection selection_, selectionAhead_;
  FailedNodes::ByNode failures_;
  std::uint64_t failuresVersion_ = 0;
  std::vector<NodeCache::Data> occluding_;
  std::vector<std::pair<double, const OccluderSet*>> bySize_;  ///< of them, by apparent size
  std::vector<NodeCache::Pin> occludingPins_;
  std::vector<NodeCache::Data> released_;
};

}  // namespace strata
