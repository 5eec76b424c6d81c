#pragma once
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <stop_token>
#include <thread>
#include <vector>

#include "core/mutex.h"
#include "core/render_list.h"
#include "core/view.h"
#include "io/store/store.h"
#include "lod/lod_pass.h"
#include "lod/streaming_state.h"
#include "lod/trace.h"

namespace strata {

/// The life of one request, by the function and the thread that does it; docs/threading.md has the whole picture:
///
///   1. setView(), any thread: a new view wakes the LOD thread.
///   2. LodPass::run(), LOD thread: the view wants the node, and the cache lacks it; it becomes a request in LoadQueue.
///   3. Loader::takeRequests(), loader thread: takes it, unless it is out of date by then (loadsDropped).
///   4. Loader::decode(), loader thread: fills a buffer with the node, or FailedNodes notes why not (failures).
///   5. Streamer::beginFrame(), render thread: puts the node into NodeCache (or refusals, duplicates).
///   6. LodPass::run(), LOD thread: finds and pins it; the list with it becomes the front one at the next beginFrame().

struct StreamerOptions {
  SelectionOptions selection;
  std::uint64_t cacheBytes = std::uint64_t{1} << 30;  ///< cap on decoded nodes; buffers on their way come on top
  int loaderThreads = 1;                              ///< at least 1
  Precision leastPrecision = Precision::low10;        ///< nodes are read at this precision, or better for near views
  bool lookAhead = true;                              ///< load for the view that setView() says is to come
  ReadLimits together;                        ///< what one read may bring; `nodes` is replaced by the empty buffers
  std::chrono::milliseconds firstRetry{250};  ///< wait after a node's first failure; each further wait is longer
  Trace* trace = nullptr;                     ///< gets a lane for each thread; must outlive the streamer
};

/// Counts since construction, except those marked "now" or "last pass".
struct StreamerStats {
  std::uint64_t nodesLoaded = 0;   ///< read and decoded
  std::uint64_t bytesRead = 0;     ///< from the store
  std::uint64_t pointsLoaded = 0;  ///< points of nodesLoaded; those of a node that is loaded again count again
  std::uint64_t reads = 0;         ///< reads that brought bytesRead
  std::uint64_t nodesAhead = 0;    ///< nodes loaded for a view to come; nodesLoaded counts them too
  std::uint64_t failures = 0;      ///< loads that ended in an error
  std::uint64_t nodesGivenUp = 0;  ///< nodes out of tries
  std::uint64_t loadsDropped = 0;  ///< taken by a loader, but no longer in view
  std::uint32_t occluded = 0;      ///< last pass: nodes left out as hidden, with everything below them
  std::uint32_t occluders = 0;     ///< last pass: pieces of surface that could hide nodes
  std::uint64_t cacheHits = 0;     ///< nodes wanted by a new view and resident
  std::uint64_t cacheMisses = 0;   ///< nodes wanted by a new view and not resident
  std::uint64_t evictions = 0;
  std::uint64_t refusals = 0;      ///< loaded nodes for which the cache had no room
  std::uint64_t duplicates = 0;    ///< loaded nodes that were there already
  std::uint64_t overCapacity = 0;  ///< nodes wanted by a new view beyond what the cache can ever hold
  std::uint64_t lodPasses = 0;
  double lodMs = 0.0;               ///< last pass: milliseconds it took
  double lodMsMean = 0.0;           ///< mean of all passes
  std::uint64_t queueLength = 0;    ///< now
  std::uint64_t residentBytes = 0;  ///< now
  std::uint64_t peakResidentBytes = 0;
  std::uint32_t residentNodes = 0;  ///< now

  /// Share of wanted nodes that were resident, 1 when nothing was wanted.
  double hitRate() const;
};

/// Keeps a render list up to date with a moving view. Starts one LOD thread and the loader threads; the thread that
/// calls beginFrame() and waitUntilComplete() is the render thread. Nothing throws after construction.
class Streamer {
 public:
  Streamer(std::shared_ptr<const Store> store, const StreamerOptions& options);
  /// Waits until each loader has decoded the node it is at, for one LOD pass, and for reads no longer than
  /// NodeReader::kPatience.
  ~Streamer();
  Streamer(const Streamer&) = delete;
  Streamer& operator=(const Streamer&) = delete;

  /// Any thread. Does nothing when the view is the same as before.
  void setView(const View& view);
  /// `ahead` is where the camera will be in about half a second. What is missing there is loaded after everything that
  /// is missing in `view`.
  void setView(const View& view, const View& ahead);
  void setSelection(const SelectionOptions& selection);

  /// Render thread, once per frame: puts loaded nodes into the cache, hands out empty buffers and swaps in the newest
  /// list. Waits only for short critical sections. The list is valid until the next beginFrame() or
  /// waitUntilComplete(). Its items may be copied; the copies must be destroyed on the render thread.
  const RenderList& beginFrame();

  /// Any thread. True when the newest list was made for the newest view and options and has everything that they want
  /// and that can be had. Nodes that are out of tries, or that the cache is too small for, cannot.
  bool complete() const;

  /// Render thread; not on the frame path. Calls beginFrame() after each event until complete(), and returns that. The
  /// next beginFrame() gives the complete list.
  bool waitUntilComplete(std::chrono::milliseconds timeout);

  /// Any thread.
  StreamerStats stats() const;
  /// Any thread; for pictures. Replaces `depths` by the newest coarse depth in metres, CoarseDepth::kSide squared, row
  /// by row; infinite where nothing is hidden.
  void copyCoarseDepth(std::vector<float>& depths) const { state_.depth.copy(depths); }

 private:
  void lodLoop(std::stop_token stop);
  void runPass(const LodTask& task, bool isNewView);
  void publish(PinnedList& list);
  void releaseList(PinnedList& list, std::vector<NodeCache::Released>& out);
  void takeLoadedNodes();
  void recycle();

  // Constant after construction.
  const std::size_t buffers_;  ///< that go round between the render thread and the loaders
  const bool lookAhead_;

  // Shared with the loaders; each part has a lock of its own.
  StreamingState state_;

  // Guarded by listMutex_: the list on its way from the LOD thread to the render thread.
  Mutex listMutex_;
  PinnedList ready_ STRATA_GUARDED_BY(listMutex_);
  bool readyIsNew_ STRATA_GUARDED_BY(listMutex_) = false;

  // Used by the LOD thread.
  TraceLane* lodLane_ = nullptr;
  LodPass pass_;
  LodOutput back_;
  std::vector<NodeCache::Released> lodReleased_;

  // Used by the render thread.
  PinnedList front_;
  PinnedList old_;  ///< holds memory for the next list, and nothing else
  std::vector<LoadedNode> loaded_;
  std::vector<NodeCache::Released> released_;
  std::vector<std::unique_ptr<StreamedNode>> spare_;

  // Written by the LOD thread. Relaxed atomics: each count is read without regard to the others.
  struct PassCounters {
    std::atomic<std::uint64_t> occluded{0}, occluders{0}, cacheHits{0}, cacheMisses{0}, overCapacity{0}, passes{0},
        ns{0}, nsTotal{0};
  };
  PassCounters passes_;

  std::vector<std::jthread> loaders_;
  std::jthread lodThread_;
};

}  // namespace strata
