#pragma once
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <stop_token>
#include <vector>

#include "core/node_data.h"

namespace strata {

/// A node that a loader has decoded.
struct LoadedNode {
  std::uint32_t node = 0;
  std::unique_ptr<NodeData> data;
};

/// Kanzok's map queue and unmap queue: empty buffers from the render thread to the loaders, filled ones back. The
/// render thread puts in one empty buffer for each that it has taken out filled, so their number never grows: memory
/// on its way is bounded, and loaders stop by themselves when no frames are drawn.
class TransferQueues {
 public:
  void giveEmpty(std::unique_ptr<NodeData> buffer);
  /// Waits for an empty buffer; null when stopped.
  std::unique_ptr<NodeData> takeEmpty(std::stop_token stop);

  void giveFilled(LoadedNode loaded);
  /// Moves all filled buffers to the end of `out`. Does not wait.
  void takeFilled(std::vector<LoadedNode>& out);

 private:
  // Guarded by mutex_.
  std::mutex mutex_;
  std::condition_variable_any emptyGiven_;
  std::vector<std::unique_ptr<NodeData>> empty_;
  std::vector<LoadedNode> filled_;
};

}  // namespace strata
