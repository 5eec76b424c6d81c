#include "lod/streamer.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "lod/loader.h"

namespace strata {
namespace {

/// Beside the one that each loader fills: Kanzok's queues of five with one loader.
constexpr std::size_t kExtraBuffers = 4;

std::size_t loaderCount(const StreamerOptions& options) {
  return static_cast<std::size_t>(std::max(options.loaderThreads, 1));
}

}  // namespace

double StreamerStats::hitRate() const {
  const std::uint64_t wanted = cacheHits + cacheMisses;
  return wanted == 0 ? 1.0 : static_cast<double>(cacheHits) / static_cast<double>(wanted);
}

Streamer::Streamer(std::shared_ptr<const Store> store, const StreamerOptions& options)
    : buffers_(loaderCount(options) + kExtraBuffers),
      lookAhead_(options.lookAhead),
      state_(std::move(store), options.cacheBytes, options.firstRetry, options.selection),
      pass_(*state_.store, state_.index, options.leastPrecision, state_.cache, state_.depth) {
  for (std::size_t i = 0; i < buffers_; ++i) state_.transfer.giveEmpty(std::make_unique<StreamedNode>());
  const auto lane = [&](const std::string& name) {
    return options.trace != nullptr ? &options.trace->addLane(name) : nullptr;
  };
  lodLane_ = lane("LOD");
  for (std::size_t i = 0; i < loaderCount(options); ++i)
    loaders_.emplace_back([this, together = options.together, own = lane("loader " + std::to_string(i + 1))](
                              std::stop_token stop) { Loader(state_, together, own).run(stop); });
  lodThread_ = std::jthread([this](std::stop_token stop) { lodLoop(stop); });
}

Streamer::~Streamer() {
  // All are asked before the first is joined, so that they end at the same time.
  lodThread_.request_stop();
  for (std::jthread& loader : loaders_) loader.request_stop();
  state_.queue.stop();
}

// --- any thread

void Streamer::setView(const View& view) { state_.board.setView(view, std::nullopt); }

void Streamer::setView(const View& view, const View& ahead) {
  state_.board.setView(view, lookAhead_ ? std::optional(ahead) : std::nullopt);
}

void Streamer::setSelection(const SelectionOptions& selection) { state_.board.setSelection(selection); }

bool Streamer::complete() const { return state_.board.complete(); }

StreamerStats Streamer::stats() const {
  const auto now = [](const std::atomic<std::uint64_t>& counter) { return counter.load(std::memory_order_relaxed); };
  const NodeCacheStats cache = state_.cache.stats();
  const LoaderCounters& loaders = state_.counters;
  StreamerStats s;
  s.nodesLoaded = now(loaders.nodesLoaded);
  s.bytesRead = now(loaders.bytesRead);
  s.pointsLoaded = now(loaders.pointsLoaded);
  s.reads = now(loaders.reads);
  s.nodesAhead = now(loaders.nodesAhead);
  s.loadsDropped = now(loaders.loadsDropped);
  s.failures = state_.failed.failures();
  s.nodesGivenUp = state_.failed.givenUp();
  s.occluded = static_cast<std::uint32_t>(now(passes_.occluded));
  s.occluders = static_cast<std::uint32_t>(now(passes_.occluders));
  s.cacheHits = now(passes_.cacheHits);
  s.cacheMisses = now(passes_.cacheMisses);
  s.overCapacity = now(passes_.overCapacity);
  s.lodPasses = now(passes_.passes);
  s.lodMs = 1e-6 * static_cast<double>(now(passes_.ns));
  if (s.lodPasses > 0)
    s.lodMsMean = 1e-6 * static_cast<double>(now(passes_.nsTotal)) / static_cast<double>(s.lodPasses);
  s.evictions = cache.evictions;
  s.refusals = cache.refusals;
  s.duplicates = cache.duplicates;
  s.queueLength = state_.queue.size();
  s.residentBytes = cache.residentBytes;
  s.peakResidentBytes = cache.peakBytes;
  s.residentNodes = cache.residentNodes;
  return s;
}

// --- LOD thread

void Streamer::lodLoop(std::stop_token stop) {
  std::uint64_t lastGeneration = 0;
  while (const std::optional<LodTask> task = state_.board.waitForTask(stop, lastGeneration)) {
    runPass(*task, task->generation != lastGeneration);
    lastGeneration = task->generation;
  }
}

void Streamer::runPass(const LodTask& task, bool isNewView) {
  const auto start = std::chrono::steady_clock::now();
  TraceScope pass(lodLane_, "LOD pass");
  const LodPass::Result built = pass_.run(task, state_.failed, start, back_, lodLane_);
  back_.pinned.list.serial = passes_.passes.load(std::memory_order_relaxed) + 1;
  pass.count("nodes", back_.pinned.list.items.size());
  TraceScope step(lodLane_, "publish");
  state_.queue.replace(back_.requests);
  publish(back_.pinned);

  const auto ns = static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now() - start).count());
  passes_.occluded.store(built.occluded, std::memory_order_relaxed);
  passes_.occluders.store(built.occluders, std::memory_order_relaxed);
  passes_.ns.store(ns, std::memory_order_relaxed);
  passes_.nsTotal.fetch_add(ns, std::memory_order_relaxed);
  passes_.passes.fetch_add(1, std::memory_order_relaxed);
  if (isNewView) {
    passes_.cacheHits.fetch_add(built.resident, std::memory_order_relaxed);
    passes_.cacheMisses.fetch_add(built.absent, std::memory_order_relaxed);
    passes_.overCapacity.fetch_add(built.overCapacity, std::memory_order_relaxed);
  }
  const bool isPending = built.requests > 0 || built.waiting > 0 || built.fading > 0;
  state_.board.passEnded(task.generation, isPending, built.retryAt);
}

void Streamer::publish(PinnedList& list) {
  {
    const MutexLock lock(listMutex_);
    std::swap(ready_, list);
    readyIsNew_ = true;
  }
  // The swap brought back an older list that no frame has drawn, or an empty one.
  releaseList(list, lodReleased_);
  lodReleased_.clear();
}

void Streamer::releaseList(PinnedList& list, std::vector<NodeCache::Released>& out) {
  list.list.items.clear();  // before the pins: recycle() takes the memory of an evicted node that nobody else holds
  state_.cache.unpin(list.pins, out);
  list.pins.clear();
}

// --- render thread

const RenderList& Streamer::beginFrame() {
  takeLoadedNodes();
  bool swapped = false;
  {
    const MutexLock lock(listMutex_);
    if (readyIsNew_) {
      std::swap(front_, ready_);
      std::swap(old_, ready_);
      readyIsNew_ = false;
      swapped = true;
    }
  }
  if (swapped) releaseList(old_, released_);
  recycle();
  return front_.list;
}

void Streamer::takeLoadedNodes() {
  loaded_.clear();
  state_.transfer.takeFilled(loaded_);
  if (loaded_.empty()) return;
  for (LoadedNode& loaded : loaded_) {
    state_.cache.insert(loaded.node, std::move(loaded.data), released_);
    state_.queue.finish(loaded.node);
  }
  recycle();
  // One empty buffer for each that came filled: their number stays the same.
  for (std::size_t i = 0; i < loaded_.size(); ++i) {
    if (spare_.empty()) spare_.push_back(std::make_unique<StreamedNode>());
    state_.transfer.giveEmpty(std::move(spare_.back()));
    spare_.pop_back();
  }
  state_.board.nodesChanged();
}

void Streamer::recycle() {
  for (NodeCache::Released& data : released_) {
    // A new object takes over the vectors, and the old one goes: a rasterizer whose weak_ptr refers to the evicted node
    // must not see another node's points in it.
    if (data.use_count() == 1 && spare_.size() < buffers_)
      spare_.push_back(std::make_unique<StreamedNode>(std::move(*data)));
  }
  released_.clear();
}

bool Streamer::waitUntilComplete(std::chrono::milliseconds timeout) {
  const auto deadline = TaskBoard::Clock::now() + timeout;
  while (true) {
    // The events are counted first, so that one during beginFrame() is not slept through.
    const std::uint64_t seen = state_.board.events();
    beginFrame();
    if (complete()) return true;
    if (!state_.board.waitForEvent(seen, deadline)) return false;
  }
}

}  // namespace strata
