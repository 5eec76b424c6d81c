#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <stop_token>
#include <vector>

#include "core/mutex.h"
#include "core/node_data.h"

namespace strata {

/// A wanted node that a loader is to read, and the range of its payload that the view needs and the cache lacks.
struct LoadRequest {
  std::uint32_t node = 0;
  Precision precision = Precision::full30;
  float priority = 0.0f;
  bool alone = false;  ///< it has failed before, so it is not read together with others
  bool ahead = false;  ///< the view to come wants it, not the newest one: it is read after all that the latter wants
  std::uint32_t from = 0;    ///< where the range begins in the payload; everything before it is in memory
  std::uint32_t bytes = 0;   ///< length of the range
  std::uint64_t offset = 0;  ///< where the range begins in points.bin
};

/// Which requests are read together.
struct ReadLimits {
  std::size_t nodes = 1;
  std::uint64_t bytes = std::uint64_t{1} << 20;  ///< most bytes of one read
  std::uint64_t gap = std::uint64_t{256} << 10;  ///< most bytes between two nodes, which are read in vain
  float waste = 0.5f;                            ///< the same limit as a share of the node behind the gap
  float leastPriority = 0.1f;                    ///< least priority of the others, as a share of the first's
};

/// The requests, most urgent first. Each LOD pass replaces them all, so one that the view no longer needs is forgotten.
/// A node that a loader has taken is in flight until finish(), release() or putBack(), and is not handed out twice in
/// the meantime. Any thread may call any member; the lock is held for one scan of the requests at most.
class LoadQueue {
 public:
  /// Takes over the requests, at most one per node. `requests` is empty then, with the memory of the old ones.
  void replace(std::vector<LoadRequest>& requests);

  /// Waits for a request whose node is not in flight and takes the most urgent one. Empty when stopped.
  std::optional<LoadRequest> pop(std::stop_token stop);
  /// Takes those too that are about as urgent and lie next to it in the file, so that one read brings them all.
  /// Replaces `out` by them, in ascending order of offset; leaves it empty when stopped.
  void pop(std::stop_token stop, const ReadLimits& limits, std::vector<LoadRequest>& out);

  /// The node has been loaded or has failed. A request for it that came in the meantime is out of date and goes too.
  void finish(std::uint32_t node);
  /// The node has not been read because it is not wanted. A request that came in the meantime stays.
  void release(std::uint32_t node);
  /// The node could not be read yet. The request is back in the queue, unless a new one came in the meantime.
  void putBack(const LoadRequest& request);

  /// Every pop(), now and later, returns without a request.
  void stop();

  std::size_t size() const;
  std::size_t inFlight() const;

 private:
  using Iterator = std::vector<LoadRequest>::iterator;
  Iterator mostUrgent() STRATA_REQUIRES(mutex_);
  Iterator nextTo(const LoadRequest& first, const LoadRequest& last, const ReadLimits& limits, float leastPriority)
      STRATA_REQUIRES(mutex_);
  bool isInFlight(std::uint32_t node) const STRATA_REQUIRES(mutex_);
  LoadRequest take(Iterator request) STRATA_REQUIRES(mutex_);
  void removeFromFlight(std::uint32_t node) STRATA_REQUIRES(mutex_);

  Condition changed_;

  mutable Mutex mutex_;
  std::vector<LoadRequest> requests_ STRATA_GUARDED_BY(mutex_);  ///< by ascending urgency
  /// At most one for each loader and each filled buffer.
  std::vector<std::uint32_t> inFlight_ STRATA_GUARDED_BY(mutex_);
  bool stopped_ STRATA_GUARDED_BY(mutex_) = false;
};

}  // namespace strata
