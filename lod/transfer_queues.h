#pragma once
#include <cstdint>
#include <memory>
#include <stop_token>
#include <vector>

#include "core/mutex.h"
#include "lod/streamed_node.h"

namespace strata {

/// A node that a loader has decoded.
struct LoadedNode {
  std::uint32_t node = 0;
  std::unique_ptr<StreamedNode> data;
};

/// The buffers on their way between the threads: empty ones from the render thread to the loaders, filled ones back
/// (Kanzok 2015, the map queue and the unmap queue). The render thread gives one empty buffer for each filled one that
/// it takes, so their number stays the same. That bounds their memory and stops the loaders while no frames are drawn.
class TransferQueues {
 public:
  void giveEmpty(std::unique_ptr<StreamedNode> buffer);
  /// Waits for an empty buffer; null when stopped.
  std::unique_ptr<StreamedNode> takeEmpty(std::stop_token stop);
  /// How many empty buffers there are right now.
  std::size_t emptyBuffers() const;
  /// Does not wait; null when there is none.
  std::unique_ptr<StreamedNode> tryTakeEmpty();

  void giveFilled(LoadedNode loaded);
  /// Moves all filled buffers to the end of `out`. Does not wait.
  void takeFilled(std::vector<LoadedNode>& out);

 private:
  Condition emptyGiven_;

  mutable Mutex mutex_;
  std::vector<std::unique_ptr<StreamedNode>> empty_ STRATA_GUARDED_BY(mutex_);
  std::vector<LoadedNode> filled_ STRATA_GUARDED_BY(mutex_);
};

}  // namespace strata
