#include "lod/streamer.h"

#include <algorithm>
#include <exception>
#include <utility>

#include "lod/contour.h"

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
    : store_(std::move(store)),
      index_(indexHierarchy(store_->hierarchy())),
      buffers_(loaderCount(options) + kExtraBuffers),
      together_(options.together),
      lookAhead_(options.lookAhead),
      cache_(options.cacheBytes, index_.parent),
      failed_(options.firstRetry),
      pass_(*store_, index_, options.leastPrecision, cache_, depth_) {
  newest_.selection = options.selection;
  for (std::size_t i = 0; i < buffers_; ++i) transfer_.giveEmpty(std::make_unique<StreamedNode>());
  const auto lane = [&](const std::string& name) {
    return options.trace != nullptr ? &options.trace->addLane(name) : nullptr;
  };
  lodLane_ = lane("LOD");
  for (std::size_t i = 0; i < loaderCount(options); ++i)
    loaders_.emplace_back(
        [this, own = lane("loader " + std::to_string(i + 1))](std::stop_token stop) { loaderLoop(stop, own); });
  lodThread_ = std::jthread([this](std::stop_token stop) { lodLoop(stop); });
}

Streamer::~Streamer() {
  lodThread_.request_stop();
  for (std::jthread& loader : loaders_) loader.request_stop();
  queue_.stop();
}

// --- any thread

void Streamer::setView(const View& view) { setTask(view, std::nullopt); }

void Streamer::setView(const View& view, const View& ahead) {
  setTask(view, lookAhead_ ? std::optional(ahead) : std::nullopt);
}

void Streamer::setTask(const View& view, const std::optional<View>& ahead) {
  {
    const std::lock_guard lock(mutex_);
    if (viewKnown_ && newest_.view == view && newest_.ahead == ahead) return;
    newest_.view = view;
    newest_.ahead = ahead;
    viewKnown_ = true;
    ++newest_.generation;
  }
  lodWake_.notify_one();
}

void Streamer::setSelection(const SelectionOptions& selection) {
  {
    const std::lock_guard lock(mutex_);
    if (newest_.selection == selection) return;
    newest_.selection = selection;
    ++newest_.generation;
  }
  lodWake_.notify_one();
}

bool Streamer::complete() const {
  const std::lock_guard lock(mutex_);
  return viewKnown_ && doneGeneration_ == newest_.generation && !donePending_;
}

LodTask Streamer::newestTask() const {
  const std::lock_guard lock(mutex_);
  return newest_;
}

void Streamer::nodesChanged() {
  {
    const std::lock_guard lock(mutex_);
    nodesChanged_ = true;
  }
  lodWake_.notify_one();
}

void Streamer::somethingHappened() {
  {
    const std::lock_guard lock(mutex_);
    ++events_;
  }
  progress_.notify_all();
}

StreamerStats Streamer::stats() const {
  const NodeCacheStats cache = cache_.stats();
  StreamerStats s;
  s.nodesLoaded = counters_.nodesLoaded.load(std::memory_order_relaxed);
  s.bytesRead = counters_.bytesRead.load(std::memory_order_relaxed);
  s.pointsLoaded = counters_.pointsLoaded.load(std::memory_order_relaxed);
  s.reads = counters_.reads.load(std::memory_order_relaxed);
  s.nodesAhead = counters_.nodesAhead.load(std::memory_order_relaxed);
  s.occluded = static_cast<std::uint32_t>(counters_.occluded.load(std::memory_order_relaxed));
  s.occluders = static_cast<std::uint32_t>(counters_.occluders.load(std::memory_order_relaxed));
  s.failures = failed_.failures();
  s.nodesGivenUp = failed_.givenUp();
  s.loadsDropped = counters_.loadsDropped.load(std::memory_order_relaxed);
  s.cacheHits = counters_.cacheHits.load(std::memory_order_relaxed);
  s.cacheMisses = counters_.cacheMisses.load(std::memory_order_relaxed);
  s.evictions = cache.evictions;
  s.refusals = cache.refusals;
  s.duplicates = cache.duplicates;
  s.overCapacity = counters_.overCapacity.load(std::memory_order_relaxed);
  s.lodPasses = counters_.lodPasses.load(std::memory_order_relaxed);
  s.lodMs = 1e-6 * static_cast<double>(counters_.lodNs.load(std::memory_order_relaxed));
  if (s.lodPasses > 0)
    s.lodMsMean = 1e-6 * static_cast<double>(counters_.lodNsTotal.load(std::memory_order_relaxed)) /
                  static_cast<double>(s.lodPasses);
  s.queueLength = queue_.size();
  s.residentBytes = cache.residentBytes;
  s.peakResidentBytes = cache.peakBytes;
  s.residentNodes = cache.residentNodes;
  return s;
}

// --- LOD thread

void Streamer::lodLoop(std::stop_token stop) {
  std::uint64_t lastGeneration = 0;
  while (true) {
    LodTask task;
    {
      std::unique_lock lock(mutex_);
      const auto hasWork = [&] { return viewKnown_ && (newest_.generation != lastGeneration || nodesChanged_); };
      if (retryAt_ == FailedNodes::Clock::time_point::max())
        lodWake_.wait(lock, stop, hasWork);
      else
        lodWake_.wait_until(lock, stop, retryAt_, hasWork);  // a failed node may be tried again, a new one has grown
      if (stop.stop_requested()) return;
      task = newest_;
      nodesChanged_ = false;
    }
    runPass(task, task.generation != lastGeneration);
    lastGeneration = task.generation;
  }
}

void Streamer::runPass(const LodTask& task, bool isNewView) {
  const auto start = std::chrono::steady_clock::now();
  TraceScope pass(lodLane_, "LOD pass");
  const LodPass::Result built = pass_.run(task, failed_, start, back_, requests_, lodLane_);
  back_.list.serial = counters_.lodPasses.load(std::memory_order_relaxed) + 1;
  pass.count("nodes", back_.list.items.size());
  counters_.occluded.store(built.occluded, std::memory_order_relaxed);
  counters_.occluders.store(built.occluders, std::memory_order_relaxed);
  const bool pending = built.requests > 0 || built.waiting > 0 || built.fading > 0;
  TraceScope step(lodLane_, "publish");
  queue_.replace(requests_);
  publish(back_);

  const auto ns = static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now() - start).count());
  counters_.lodNs.store(ns, std::memory_order_relaxed);
  counters_.lodNsTotal.fetch_add(ns, std::memory_order_relaxed);
  counters_.lodPasses.fetch_add(1, std::memory_order_relaxed);
  if (isNewView) {
    counters_.cacheHits.fetch_add(built.resident, std::memory_order_relaxed);
    counters_.cacheMisses.fetch_add(built.absent, std::memory_order_relaxed);
    counters_.overCapacity.fetch_add(built.overCapacity, std::memory_order_relaxed);
  }
  {
    const std::lock_guard lock(mutex_);
    doneGeneration_ = task.generation;
    donePending_ = pending;
    retryAt_ = built.retryAt;
  }
  somethingHappened();
}

void Streamer::publish(PinnedList& list) {
  {
    const std::lock_guard lock(listMutex_);
    std::swap(ready_, list);
    readyIsNew_ = true;
  }
  // What comes back is an older list that no frame was drawn from, or an empty one.
  releaseList(list, lodReleased_);
  lodReleased_.clear();
}

void Streamer::releaseList(PinnedList& list, std::vector<NodeCache::Data>& out) {
  list.list.items.clear();  // before the pins: an evicted node's memory is used again when nobody else has it
  cache_.unpin(list.pins, out);
  list.pins.clear();
}

// --- loader threads

void Streamer::loaderLoop(std::stop_token stop, TraceLane* lane) {
  NodeLoader loader(store_);
  std::vector<LoadRequest> requests;
  while (std::unique_ptr<StreamedNode> buffer = transfer_.takeEmpty(stop)) {
    while (buffer != nullptr) {
      ReadLimits limits = together_;
      limits.nodes = 1 + transfer_.emptyBuffers();
      queue_.pop(stop, limits, requests);
      if (requests.empty()) return;
      keepWanted(requests);
      if (!requests.empty() && !loadTogether(loader, requests, stop, lane, buffer)) return;
    }
  }
}

/// Repeats the LOD pass's tests for the newest view (Kanzok 2015, 3.2.3).
bool Streamer::stillWanted(const LoadRequest& request) {
  const LodTask task = newestTask();
  const Contour contour = contourOf(store_->hierarchy().nodes[request.node]);
  const double reach = static_cast<double>(index_.reach[request.node]);
  if (!mayBeLeftBy(task.selection.clip, contour, reach)) return false;
  if (request.ahead && task.ahead && contourInView(contour, reach, ViewVolume(*task.ahead))) return true;
  if (!contourInView(contour, reach, ViewVolume(task.view))) return false;
  if (request.node == 0 || !task.selection.occlusion.enabled) return true;
  return !depth_.hides(task.view, contour, reach);
}

void Streamer::keepWanted(std::vector<LoadRequest>& requests) {
  std::erase_if(requests, [this](const LoadRequest& request) {
    const NodeCache::Data present = cache_.peek(request.node);
    if ((present != nullptr ? present->leadingBytes : 0) != request.from || failed_.mustWait(request.node)) {
      queue_.finish(request.node);  // came or failed between the LOD pass's look and its new queue
      return true;
    }
    if (stillWanted(request)) return false;
    counters_.loadsDropped.fetch_add(1, std::memory_order_relaxed);
    queue_.release(request.node);
    return true;
  });
}

/// Leaves the buffer where it is when no node came to fill it. False when stopped.
bool Streamer::loadTogether(NodeLoader& loader, std::span<const LoadRequest> requests, std::stop_token stop,
                            TraceLane* lane, std::unique_ptr<StreamedNode>& buffer) {
  try {
    TraceScope span(lane, "read");
    const std::uint64_t bytes = loader.read(requests, stop);
    span.count("bytes", bytes);
    if (bytes == 0) return false;
    counters_.bytesRead.fetch_add(bytes, std::memory_order_relaxed);
    counters_.reads.fetch_add(1, std::memory_order_relaxed);
  } catch (const std::exception& error) {
    for (const LoadRequest& request : requests) {
      failed_.add(request.node, error.what());
      queue_.finish(request.node);
    }
    nodesChanged();
    somethingHappened();
    return true;
  }
  std::vector<LoadRequest> tooShort;
  for (const LoadRequest& request : requests) {
    if (stop.stop_requested()) return false;
    if (buffer == nullptr) buffer = transfer_.tryTakeEmpty();
    if (buffer == nullptr) {
      queue_.putBack(request);  // another loader was quicker to take the buffer
    } else {
      TraceScope span(lane, "decode");
      span.count("node", request.node);
      if (!finishLoad(loader, request, buffer)) tooShort.push_back(request);
    }
  }
  for (LoadRequest& request : tooShort) {  // rare: less of the node was asked for than has its first positions
    request.bytes = drawBytes(store_->hierarchy().nodes[request.node], request.precision);
    if (buffer == nullptr) buffer = transfer_.tryTakeEmpty();
    if (buffer == nullptr)
      queue_.putBack(request);
    else if (!loadTogether(loader, {&request, 1}, stop, lane, buffer))
      return false;
  }
  return true;
}

/// False when the request was for too few bytes.
bool Streamer::finishLoad(NodeLoader& loader, const LoadRequest& request, std::unique_ptr<StreamedNode>& buffer) {
  try {
    const NodeCache::Data before = request.from > 0 ? cache_.peek(request.node) : nullptr;
    if ((before != nullptr ? before->leadingBytes : 0) != request.from) {  // evicted, or another was quicker
      queue_.finish(request.node);
      nodesChanged();
      return true;
    }
    if (!loader.decode(request, before.get(), newestTask().selection.occlusion.enabled, *buffer)) return false;
    counters_.nodesLoaded.fetch_add(1, std::memory_order_relaxed);
    counters_.pointsLoaded.fetch_add(buffer->pointCount(), std::memory_order_relaxed);
    if (request.ahead) counters_.nodesAhead.fetch_add(1, std::memory_order_relaxed);
    transfer_.giveFilled({request.node, std::move(buffer)});
  } catch (const std::exception& error) {
    failed_.add(request.node, error.what());
    queue_.finish(request.node);
    nodesChanged();
  }
  somethingHappened();
  return true;
}

// --- render thread

const RenderList& Streamer::beginFrame() {
  takeLoadedNodes();
  bool swapped = false;
  {
    const std::lock_guard lock(listMutex_);
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
  transfer_.takeFilled(loaded_);
  if (loaded_.empty()) return;
  for (LoadedNode& loaded : loaded_) {
    cache_.insert(loaded.node, std::move(loaded.data), released_);
    queue_.finish(loaded.node);
  }
  recycle();
  for (std::size_t i = 0; i < loaded_.size(); ++i) {
    if (spare_.empty()) spare_.push_back(std::make_unique<StreamedNode>());
    transfer_.giveEmpty(std::move(spare_.back()));
    spare_.pop_back();
  }
  nodesChanged();
}

void Streamer::recycle() {
  for (NodeCache::Data& data : released_) {
    // The nodes were made as such, see takeLoadedNodes(). A new object around the old vectors: who still has a
    // weak_ptr to the evicted node must not see another node's points.
    if (data.use_count() == 1 && spare_.size() < buffers_)
      spare_.push_back(std::make_unique<StreamedNode>(std::move(const_cast<StreamedNode&>(*data))));
  }
  released_.clear();
}

bool Streamer::waitUntilComplete(std::chrono::milliseconds timeout) {
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  while (true) {
    std::uint64_t seen = 0;
    {
      const std::lock_guard lock(mutex_);
      seen = events_;
    }
    beginFrame();
    if (complete()) return true;
    std::unique_lock lock(mutex_);
    if (!progress_.wait_until(lock, deadline, [&] { return events_ != seen; })) return false;
  }
}

}  // namespace strata
