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
  bool alone = false;        ///< has failed before: not to be read together with others
  bool ahead = false;        ///< not for the view, but for where the camera will soon be: after all that are
  std::uint32_t bytes = 0;   ///< to be read ...
  std::uint64_t offset = 0;  ///< ... from here in points.bin ...
  std::uint32_t from = 0;    ///< ... which is so far into the node's payload: what stands before is there already
};

/// Requests that are read together.
struct ReadLimits {
  std::size_t nodes = 1;
  std::uint64_t bytes = std::uint64_t{1} << 20;  ///< of the whole read
  std::uint64_t gap = std::uint64_t{256} << 10;  ///< bytes between two nodes that are read in vain
  float waste = 0.5f;                            ///< the same as a share of the node that they bring
  float leastPriority = 0.1f;                    ///< share of the first's
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
  /// The same, and then those of about the same urgency that lie next to it in the file, so that one read brings them
  /// all; by ascending offset. Replaces `out`; empty when stopped.
  void pop(std::stop_token stop, const ReadLimits& limits, std::vector<LoadRequest>& out);

  /// The node has been loaded or has failed: a request for it that came meanwhile is out of date and goes too.
  void finish(std::uint32_t node);
  /// The node was given up unread: a request that came meanwhile stays.
  void release(std::uint32_t node);
  /// It was not even begun with: the request stands as before, unless a new one came meanwhile.
  void putBack(const LoadRequest& request);

  /// Every pop(), now and later, returns none.
  void stop();

  std::size_t size() const;
  std::size_t inFlight() const;

 private:
  using Iterator = std::vector<LoadRequest>::iterator;
  // Both with mutex_ held.
  Iterator mostUrgent();
  Iterator nextTo(const LoadRequest& first, const LoadRequest& last, const ReadLimits& limits, float leastPriority);
  bool isInFlight(std::uint32_t node) const;
  LoadRequest take(Iterator request);
  void removeFromFlight(std::uint32_t node);

  // Guarded by mutex_.
  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  std::vector<LoadRequest> requests_;    ///< by ascending urgency
  std::vector<std::uint32_t> inFlight_;  ///< at most one a loader and one a finished buffer
  bool stopped_ = false;
};

}  // namespace strata
