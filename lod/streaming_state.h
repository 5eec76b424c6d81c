#pragma once
#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <utility>

#include "io/store/store.h"
#include "lod/depth_buffers.h"
#include "lod/failed_nodes.h"
#include "lod/hierarchy_index.h"
#include "lod/load_queue.h"
#include "lod/node_cache.h"
#include "lod/task_board.h"
#include "lod/transfer_queues.h"

namespace strata {

/// Counts of the loaders' work. Relaxed atomics: each count is read without regard to the others.
struct LoaderCounters {
  std::atomic<std::uint64_t> nodesLoaded{0}, nodesAhead{0}, pointsLoaded{0}, bytesRead{0}, reads{0}, loadsDropped{0};

  static void add(std::atomic<std::uint64_t>& counter, std::uint64_t count) {
    counter.fetch_add(count, std::memory_order_relaxed);
  }
};

/// Everything that the threads of a streamer share. Each part is constant or has a lock of its own, so any thread may
/// use any of them; no thread uses one while it holds the lock of another.
struct StreamingState {
  StreamingState(std::shared_ptr<const Store> opened, std::uint64_t cacheBytes, std::chrono::milliseconds firstRetry,
                 const SelectionOptions& selection)
      : store(std::move(opened)),
        index(indexHierarchy(store->hierarchy())),
        cache(cacheBytes, index.parent),
        failed(firstRetry),
        board(selection) {}

  const std::shared_ptr<const Store> store;
  const HierarchyIndex index;

  NodeCache cache;
  LoadQueue queue;
  TransferQueues transfer;
  FailedNodes failed;
  DepthBuffers depth;
  TaskBoard board;
  LoaderCounters counters;
};

}  // namespace strata
