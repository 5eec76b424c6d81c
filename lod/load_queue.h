#pragma once
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <stop_token>
#include <vector>

#include "core/node_data.h"

namespace strata {

struct LoadRequest {
  std::uint32_t node = 0;
  Precision precision = Precision::full30;
  float priority = 0.0f;
};

/// What is to be loaded, most urgent first. Each LOD pass replaces it whole, so a request that the view no longer asks
/// for is forgotten. A node that a loader has taken is in flight until finish() or release(), and is not handed out
/// twice meanwhile. Every member may be called by any thread; no call holds the lock for longer than it takes to sort.
class LoadQueue {
 public:
  /// Takes over the requests (at most one a node) and leaves the old ones' memory in `requests`, empty.
  void replace(std::vector<LoadRequest>& requests);

  /// The most urgent request whose node is not in flight; waits for one. None when stopped.
  std::optional<LoadRequest> pop(std::stop_token stop);

  /// The node has been loaded or has failed: a request for it that came meanwhile is out of date and goes too.
  void finish(std::uint32_t node);
  /// The node was given up unread: a request that came meanwhile stays.
  void release(std::uint32_t node);

  /// Every pop(), now and later, returns none.
  void stop();

  std::size_t size() const;
  std::size_t inFlight() const;

 private:
  using Iterator = std::vector<LoadRequest>::iterator;
  // Both with mutex_ held.
  Iterator mostUrgent();
  void removeFromFlight(std::uint32_t node);

  // Guarded by mutex_.
  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  std::vector<LoadRequest> requests_;    ///< by ascending urgency
  std::vector<std::uint32_t> inFlight_;  ///< at most one a loader and one a finished buffer
  bool stopped_ = false;
};

}  // namespace strata
