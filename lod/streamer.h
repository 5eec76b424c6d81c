#pragma once
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <stop_token>
#include <thread>
#include <vector>

#include "core/render_list.h"
#include "core/view.h"
#include "io/store/store.h"
#include "lod/depth_buffers.h"
#include "lod/failed_nodes.h"
#include "lod/hierarchy_index.h"
#include "lod/list_builder.h"
#include "lod/load_queue.h"
#include "lod/lod_pass.h"
#include "lod/node_cache.h"
#include "lod/node_loader.h"
#include "lod/selection.h"
#include "lod/trace.h"
#include "lod/transfer_queues.h"

// The life of one request:
//   1. setView()                 any thread     a new view wakes the LOD thread
//   2. Streamer::runPass()       LOD thread     selectNodes() wants the node, NodeCache::pin() does not find it,
//                                               LoadQueue::replace() makes it a request
//   3. Streamer::loaderLoop()    loader thread  TransferQueues::takeEmpty() gives memory, LoadQueue::pop() the request
//                                               and its neighbours in the file; out of the newest view or hidden in it:
//                                               forgotten (loadsDropped)
//   4. NodeLoader                loader thread  read() and decode(); TransferQueues::giveFilled(), or
//   FailedNodes::add()
//                                               (failures; tried again later, after kMaxAttempts nodesGivenUp)
//   5. beginFrame()              render thread  NodeCache::insert() (or refusals, duplicates), memory of evicted nodes
//                                               goes back as empty buffers, the LOD thread wakes
//   6. Streamer::runPass()       LOD thread     finds it, pins it, publishes a list with it; the next beginFrame()
//                                               makes that list the front one. docs/threading.md has the whole picture.

namespace strata {

struct StreamerOptions {
  SelectionOptions selection;
  std::uint64_t cacheBytes = std::uint64_t{1} << 30;  ///< cap on decoded nodes; buffers on their way are beside it
  int loaderThreads = 1;                              ///< at least 1
  Precision leastPrecision = Precision::low10;        ///< of what is read, whatever the view needs
  bool lookAhead = true;                              ///< load for the view that setView() says is to come
  ReadLimits together;                                ///< what is read at once; `nodes` is as many as there are buffers
  std::chrono::milliseconds firstRetry{250};          ///< after a node has failed to load; each further wait is longer
  Trace* trace = nullptr;                             ///< gets lanes of the threads; must outlive the streamer
};

/// Counts since construction, except where it says otherwise.
struct StreamerStats {
  std::uint64_t nodesLoaded = 0;   ///< read and decoded
  std::uint64_t bytesRead = 0;     ///< from the store
  std::uint64_t pointsLoaded = 0;  ///< of nodesLoaded, each time again
  std::uint64_t reads = 0;         ///< that these bytes came in
  std::uint64_t nodesAhead = 0;    ///< of nodesLoaded, those for a view to come
  std::uint64_t failures = 0;      ///< loads that ended in an error
  std::uint64_t nodesGivenUp = 0;  ///< nodes out of tries
  std::uint64_t loadsDropped = 0;  ///< taken by a loader, but no longer in view
  std::uint32_t occluded = 0;      ///< nodes that the last pass left out, and all below them, as hidden
  std::uint32_t occluders = 0;     ///< pieces of surface behind which the last pass looked for them
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
  /// Waits for at most one decoding a loader, one LOD pass, and NodeReader::kPatience for reads; never for a read that
  /// takes longer.
  ~Streamer();
  Streamer(const Streamer&) = delete;
  Streamer& operator=(const Streamer&) = delete;

  /// Any thread. Does nothing when the view is the same as before.
  void setView(const View& view);
  /// The same, and where the camera will be in about half a second: what is missing there is loaded after everything
  /// that is missing here.
  void setView(const View& view, const View& ahead);
  void setSelection(const SelectionOptions& selection);

  /// Render thread, once a frame: puts loaded nodes into the cache, hands out empty buffers and swaps in the newest
  /// list. Waits for nothing but short critical sections. The list is valid until the next beginFrame() or
  /// waitUntilComplete(); the RenderItems may be copied, but must be let go on the render thread.
  const RenderList& beginFrame();

  /// Any thread: the newest list is for the newest view and options, has all points of its nodes that are wanted, and
  /// lacks nothing that can be had (nodes out of tries, and what a too small cache cannot hold, are done without).
  bool complete() const;

  /// Render thread; not on the frame path. Calls beginFrame() each time that something has happened until complete(),
  /// which is returned. The next beginFrame() gives the complete list.
  bool waitUntilComplete(std::chrono::milliseconds timeout);

  /// Any thread.
  StreamerStats stats() const;
  /// Any thread; for pictures of it. The depths of the newest coarse depth buffer, CoarseDepth::kSide squared, row by
  /// row; infinite where nothing is hidden.
  void copyCoarseDepth(std::vector<float>& depths) const { depth_.copy(depths); }

 private:
  void lodLoop(std::stop_token stop);
  void runPass(const LodTask& task, bool isNewView);
  void publish(PinnedList& list);
  void loaderLoop(std::stop_token stop, TraceLane* lane);
  bool stillWanted(const LoadRequest& request);
  void keepWanted(std::vector<LoadRequest>& requests);
  bool loadTogether(NodeLoader& loader, std::span<const LoadRequest> requests, std::stop_token stop, TraceLane* lane,
                    std::unique_ptr<StreamedNode>& buffer);
  bool finishLoad(NodeLoader& loader, const LoadRequest& request, std::unique_ptr<StreamedNode>& buffer);
  void releaseList(PinnedList& list, std::vector<NodeCache::Data>& out);
  void takeLoadedNodes();
  void recycle();
  void nodesChanged();
  void somethingHappened();
  LodTask newestTask() const;
  void setTask(const View& view, const std::optional<View>& ahead);

  // Constant after construction.
  const std::shared_ptr<const Store> store_;
  const HierarchyIndex index_;
  const std::size_t buffers_;  ///< in circulation between render thread and loaders
  const ReadLimits together_;
  const bool lookAhead_;

  // Each with its own lock, see there.
  NodeCache cache_;
  LoadQueue queue_;
  TransferQueues transfer_;
  FailedNodes failed_;
  DepthBuffers depth_;

  // Guarded by mutex_: what the threads tell each other.
  mutable std::mutex mutex_;
  std::condition_variable_any lodWake_;
  std::condition_variable_any progress_;
  LodTask newest_;
  bool viewKnown_ = false;     ///< setView() has been called
  bool nodesChanged_ = false;  ///< loaded or failed since the last pass began
  FailedNodes::Clock::time_point retryAt_ = FailedNodes::Clock::time_point::max();  ///< when a pass is due by itself
  std::uint64_t doneGeneration_ = 0;                                                ///< of the last published list
  bool donePending_ = false;                                                        ///< requests were open after it
  std::uint64_t events_ = 0;  ///< lists published and loads ended, for waitUntilComplete()

  // Guarded by listMutex_: the list on its way from the LOD thread to the render thread.
  std::mutex listMutex_;
  PinnedList ready_;
  bool readyIsNew_ = false;

  // Used by the LOD thread.
  TraceLane* lodLane_ = nullptr;
  LodPass pass_;
  PinnedList back_;
  std::vector<LoadRequest> requests_;
  std::vector<NodeCache::Data> lodReleased_;

  // Used by the render thread.
  PinnedList front_;
  PinnedList old_;  ///< empty but for its memory
  std::vector<LoadedNode> loaded_;
  std::vector<NodeCache::Data> released_;
  std::vector<std::unique_ptr<StreamedNode>> spare_;

  // Counters, relaxed: each is read by itself.
  struct Counters {
    std::atomic<std::uint64_t> nodesLoaded{0}, nodesAhead{0}, pointsLoaded{0}, bytesRead{0}, reads{0}, loadsDropped{0},
        occluded{0}, occluders{0}, cacheHits{0}, cacheMisses{0}, overCapacity{0}, lodPasses{0}, lodNs{0}, lodNsTotal{0};
  };
  Counters counters_;

  std::vector<std::jthread> loaders_;
  std::jthread lodThread_;
};

}  // namespace strata
