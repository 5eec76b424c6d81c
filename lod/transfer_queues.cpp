#include "lod/transfer_queues.h"

#include <iterator>
#include <utility>

namespace strata {

void TransferQueues::giveEmpty(std::unique_ptr<StreamedNode> buffer) {
  {
    const MutexLock lock(mutex_);
    empty_.push_back(std::move(buffer));
  }
  emptyGiven_.notify_one();
}

std::unique_ptr<StreamedNode> TransferQueues::takeEmpty(std::stop_token stop) {
  const MutexLock lock(mutex_);
  if (!emptyGiven_.wait(mutex_, stop, [this]() STRATA_REQUIRES(mutex_) { return !empty_.empty(); })) return nullptr;
  std::unique_ptr<StreamedNode> buffer = std::move(empty_.back());
  empty_.pop_back();
  return buffer;
}

std::size_t TransferQueues::emptyBuffers() const {
  const MutexLock lock(mutex_);
  return empty_.size();
}

std::unique_ptr<StreamedNode> TransferQueues::tryTakeEmpty() {
  const MutexLock lock(mutex_);
  if (empty_.empty()) return nullptr;
  std::unique_ptr<StreamedNode> buffer = std::move(empty_.back());
  empty_.pop_back();
  return buffer;
}

void TransferQueues::giveFilled(LoadedNode loaded) {
  const MutexLock lock(mutex_);
  filled_.push_back(std::move(loaded));
}

void TransferQueues::takeFilled(std::vector<LoadedNode>& out) {
  const MutexLock lock(mutex_);
  std::move(filled_.begin(), filled_.end(), std::back_inserter(out));
  filled_.clear();
}

}  // namespace strata
