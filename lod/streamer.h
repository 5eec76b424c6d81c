#pragma once
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <stop_token>
#include <thread>
#include <vector>

#include "core/render_list.h"
#include "core/view.h"
#include "io/store.h"
#include "lod/failed_nodes.h"
#include "lod/hierarchy_index.h"
#include "lod/list_builder.h"
#include "lod/load_queue.h"
#include "lod/node_cache.h"
#include "lod/node_loader.h"
#include "lod/selection.h"
#include "lod/transfer_queues.h"

// The life of one request:
//   1. setView()                 any thread     a new view wakes the LOD thread
//   2. Streamer::runPass()       LOD thread     selectNodes() wants the node, NodeCache::pin() does not find it,
//                                               LoadQueue::replace() makes it a request
//   3. Streamer::loaderLoop()    loader thread  TransferQueues::takeEmpty() gives memory, LoadQueue::pop() the request;
//                                               out of the newest view: forgotten (loadsDropped)
//   4. NodeLoader::load()        loader thread  reads and decodes; TransferQueues::giveFilled(), or FailedNodes::add()
//                                               (failures, after FailedNodes::kMaxAttempts nodesGivenUp)
//   5. beginFrame()              render thread  NodeCache::insert() (or refusals, duplicates), memory of evicted nodes
//                                               goes back as empty buffers, the LOD thread wakes
//   6. Streamer::runPass()       LOD thread     finds it, pins it, publishes a list with it; the next beginFrame()
//                                               makes that list the front one. docs/threading.md has the whole picture.

namespace strata {

struct StreamerOptions {
  SelectionOptions selection;
  std::uint64_t cacheBytes = std::uint64_t{1} << 30;  ///< cap on decoded nodes; buffers on their way are beside it
  int loaderThreads = 1;                              ///< at least 1
};

/// Counts since construction, except where it says otherwise.
struct StreamerStats {
  std::uint64_t nodesLoaded = 0;   ///< read and decoded
  std::uint64_t bytesRead = 0;     ///< of those
  std::uint64_t failures = 0;      ///< loads that ended in an error
  std::uint64_t nodesGivenUp = 0;  ///< nodes out of tries
  std::uint64_t loadsDropped = 0;  ///< taken by a loader, but no longer in view
  std::uint64_t cacheHits = 0;     ///< nodes wanted by a new view and resident
  std::uint64_t cacheMisses = 0;   ///< nodes wanted by a new view and not resident
  std::uint64_t evictions = 0;
  std::uint64_t refusals = 0;      ///< loaded nodes for which the cache had no room
  std::uint64_t duplicates = 0;    ///< loaded nodes that were there already
  std::uint64_t overCapacity = 0;  ///< nodes wanted by a new view beyond what the cache can ever hold
  std::uint64_t lodPasses = 0;
  double lodMs = 0.0;               ///< of the last pass
  double lodMsMean = 0.0;           ///< over all passes
  std::uint64_t queueLength = 0;    ///< now
  std::uint64_t residentBytes = 0;  ///< now
  std::uint64_t peakResidentBytes = 0;
  std::uint32_t residentNodes = 0;  ///< now

  /// Share of wanted nodes that were resident, 1 when nothing was wanted.
  double hitRate() const;
};

/// Keeps a render list up to date with a moving view. Starts one LOD thread and the loader threads; the thread that
/// calls beginFrame() and waitUntilComplete() is the render thread. Nothing here throws after construction.
class Streamer {
 public:
  Streamer(std::shared_ptr<const Store> store, const StreamerOptions& options);
  /// Waits for at most one read of NodeLoader::kMaxReadBytes and one decoding a loader, and for one LOD pass.
  ~Streamer();
  Streamer(const Streamer&) = delete;
  Streamer& operator=(const Streamer&) = delete;

  /// Any thread. Does nothing when the view is the same as before.
  void setView(const View& view);
  void setSelection(const SelectionOptions& selection);

  /// Render thread, once a frame: puts loaded nodes into the cache, hands out empty buffers and swaps in the newest
  /// list. Waits for nothing but short critical sections. The list is valid until the next beginFrame() or
  /// waitUntilComplete(); the RenderItems may be copied, but must be let go on the render thread.
  const RenderList& beginFrame();

  /// Any thread: the newest list is for the newest view and options and lacks nothing that can be had (nodes out of
  /// tries, and what a too small cache cannot hold, are done without).
  bool complete() const;

  /// Render thread; not on the frame path. Calls beginFrame() each time that something has happened until complete(),
  /// which is returned. The next beginFrame() gives the complete list.
  bool waitUntilComplete(std::chrono::milliseconds timeout);

  /// Any thread.
  StreamerStats stats() const;

 private:
  /// What an LOD pass works on.
  struct Task {
    View view;
    SelectionOptions selection;
    std::uint64_t generation = 0;  ///< counts setView() and setSelection()
  };

  void lodLoop(std::stop_token stop);
  void runPass(const Task& task, bool isNewView);
  void publish(PinnedList& list);
  void loaderLoop(std::stop_token stop);
  bool loadOne(NodeLoader& loader, const LoadRequest& request, std::stop_token stop, std::unique_ptr<NodeData>& buffer);
  void releaseList(PinnedList& list, std::vector<NodeCache::Data>& out);
  void takeLoadedNodes();
  void recycle();
  void nodesChanged();
  void somethingHappened();
  View newestView() const;

  // Constant after construction.
  const std::shared_ptr<const Store> store_;
  const HierarchyIndex index_;
  const std::size_t buffers_;  ///< in circulation between render thread and loaders

  // Each with its own lock, see there.
  NodeCache cache_;
  LoadQueue queue_;
  TransferQueues transfer_;
  FailedNodes failed_;

  // Guarded by mutex_: what the threads tell each other.
  mutable std::mutex mutex_;
  std::condition_variable_any lodWake_;
  std::condition_variable_any progress_;
  Task newest_;
  bool viewKnown_ = false;            ///< setView() has been called
  bool nodesChanged_ = false;         ///< loaded or failed since the last pass began
  std::uint64_t doneGeneration_ = 0;  ///< of the last published list
  bool donePending_ = false;          ///< requests were open after it
  std::uint64_t events_ = 0;          ///< lists published and loads ended, for waitUntilComplete()

  // Guarded by listMutex_: the list on its way from the LOD thread to the render thread.
  std::mutex listMutex_;
  PinnedList ready_;
  bool readyIsNew_ = false;

  // Used by the LOD thread.
  Selection selection_;
  ListBuilder builder_;
  PinnedList back_;
  std::vector<LoadRequest> requests_;
  ListBuilder::Attempts attempts_;
  std::uint64_t attemptsVersion_ = 0;
  std::vector<NodeCache::Data> lodReleased_;

  // Used by the render thread.
  PinnedList front_;
  PinnedList old_;  ///< empty but for its memory
  std::vector<LoadedNode> loaded_;
  std::vector<NodeCache::Data> released_;
  std::vector<std::unique_ptr<NodeData>> spare_;

  // Counters, relaxed: each is read by itself.
  struct Counters {
    std::atomic<std::uint64_t> nodesLoaded{0}, bytesRead{0}, loadsDropped{0}, cacheHits{0}, cacheMisses{0},
        overCapacity{0}, lodPasses{0}, lodNs{0}, lodNsTotal{0};
  };
  Counters counters_;

  std::vector<std::jthread> loaders_;
  std::jthread lodThread_;
};

}  // namespace strata
