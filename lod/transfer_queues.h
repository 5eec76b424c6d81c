#pragma once
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <stop_token>
#include <vector>

#include "lod/streamed_node.h"

namespace strata {

/// A node that a loader has decoded.
struct LoadedNode {
  std::uint32_t node = 0;
  std::unique_ptr<StreamedNode> data;
};

/// Kanzok's map queue and unmap queue: empty buffers from the render thread to the loaders, filled ones back. The
/// render thread puts in one empty buffer for each that it has taken out filled, so their number never grows: memory
/// on its way is bounded, and loaders stop by themselves when no frames are drawn.
class TransferQueues {
 public:
  void giveEmpty(std::unique_ptr<StreamedNode> buffer);
  /// Waits for an empty buffer; null when stopped.
  std::unique_ptr<StreamedNode> takeEmpty(std::stop_token stop);
  /// Buffers that are there right now.
  std::size_t emptyBuffers() const;
  /// Does not wait; null when there is none.
  std::unique_ptr<StreamedNode> tryTakeEmpty();

  void giveFilled(LoadedNode loaded);
  /// Moves all filled buffers to the end of `out`. Does not wait.
  void takeFilled(std::vector<LoadedNode>& out);

 private:
  // Guarded by mutex_.
  mutable std::mutex mutex_;
  std::condition_variable_any emptyGiven_;
  std::vector<std::unique_ptr<StreamedNode>> empty_;
  std::vector<LoadedNode> filled_;
};

}  // namespace strata
