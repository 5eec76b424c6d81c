#include "lod/loader.h"

#include <algorithm>
#include <exception>
#include <utility>

#include "io/store/node_codec.h"
#include "lod/clip_region.h"
#include "lod/contour.h"

namespace strata {
namespace {

/// How many leading bytes of a node are in memory.
std::uint32_t leadingBytes(const NodeCache::Data& present) { return present != nullptr ? present->leadingBytes : 0; }

}  // namespace

Loader::Loader(StreamingState& state, const ReadLimits& limits, TraceLane* lane)
    : state_(state), limits_(limits), lane_(lane), reader_(state.store), decoder_(state.store) {}

void Loader::run(std::stop_token stop) {
  while (takeBuffer(stop) && takeRequests(stop)) {
    dropUnwanted();
    load(stop);
  }
}

bool Loader::takeBuffer(std::stop_token stop) {
  if (buffer_ == nullptr) buffer_ = state_.transfer.takeEmpty(stop);
  return buffer_ != nullptr;
}

/// Takes a buffer where there is none and one is empty; does not wait.
bool Loader::hasBuffer() {
  if (buffer_ == nullptr) buffer_ = state_.transfer.tryTakeEmpty();
  return buffer_ != nullptr;
}

bool Loader::takeRequests(std::stop_token stop) {
  // No more than there are buffers for now; when other loaders take those first, decode() puts the rest back.
  ReadLimits limits = limits_;
  limits.nodes = 1 + state_.transfer.emptyBuffers();
  state_.queue.pop(stop, limits, requests_);
  return !requests_.empty();
}

void Loader::dropUnwanted() {
  std::erase_if(requests_, [this](const LoadRequest& request) {
    const bool isOutdated = leadingBytes(state_.cache.peek(request.node)) != request.from;
    if (isOutdated || state_.failed.mustWait(request.node)) {
      // It came or failed after the LOD pass had looked for it and before the queue got the pass's requests.
      state_.queue.finish(request.node);
      return true;
    }
    if (isStillWanted(request)) return false;
    LoaderCounters::add(state_.counters.loadsDropped, 1);
    state_.queue.release(request.node);
    return true;
  });
}

/// Repeats the tests of the LOD pass for the newest view (Kanzok 2015, 3.2.3).
bool Loader::isStillWanted(const LoadRequest& request) const {
  const LodTask task = state_.board.newest();
  const Contour contour = contourOf(state_.store->hierarchy().nodes[request.node]);
  const double reach = static_cast<double>(state_.index.reach[request.node]);
  if (!mayBeLeftBy(task.selection.shown.clip, contour, reach)) return false;
  if (request.ahead && task.ahead && contourInView(contour, reach, ViewVolume(*task.ahead))) return true;
  if (!contourInView(contour, reach, ViewVolume(task.view))) return false;
  if (request.node == 0 || !task.selection.occlusion.enabled) return true;
  return !state_.depth.hides(task.view, contour, reach);
}

void Loader::load(std::stop_token stop) {
  if (!requests_.empty()) loadTogether(requests_, stop);
  // Rare: the LOD pass guessed fewer bytes than the node's first positions take. Each of them is read again, as far as
  // its precision may need, which is enough.
  while (!tooShort_.empty() && !stop.stop_requested()) {
    LoadRequest request = tooShort_.back();
    tooShort_.pop_back();
    request.bytes = drawBytes(state_.store->hierarchy().nodes[request.node], request.precision);
    if (hasBuffer())
      loadTogether({&request, 1}, stop);
    else
      state_.queue.putBack(request);
  }
}

/// Gives back to the queue what there is no buffer for. Returns early when stopped.
void Loader::loadTogether(std::span<const LoadRequest> requests, std::stop_token stop) {
  const std::span<const std::byte> bytes = read(requests, stop);
  if (bytes.empty()) return;
  for (const LoadRequest& request : requests) {
    if (stop.stop_requested()) return;
    if (hasBuffer())
      decode(request, bytes.subspan(static_cast<std::size_t>(request.offset - requests.front().offset), request.bytes));
    else
      state_.queue.putBack(request);  // another loader was quicker to take the buffer
  }
}

/// Reads from the beginning of the first request to the end of the last. Empty when stopped, or after a failure, which
/// then all requests share.
std::span<const std::byte> Loader::read(std::span<const LoadRequest> requests, std::stop_token stop) {
  const LoadRequest &first = requests.front(), &last = requests.back();
  TraceScope span(lane_, "read");
  try {
    const std::span<const std::byte> bytes =
        reader_.read(first.offset, static_cast<std::size_t>(last.offset + last.bytes - first.offset), stop);
    span.count("bytes", bytes.size());
    if (bytes.empty()) return {};
    LoaderCounters::add(state_.counters.bytesRead, bytes.size());
    LoaderCounters::add(state_.counters.reads, 1);
    return bytes;
  } catch (const std::exception& error) {
    for (const LoadRequest& request : requests) fail(request, error.what());
    return {};
  }
}

void Loader::decode(const LoadRequest& request, std::span<const std::byte> bytes) {
  TraceScope span(lane_, "decode");
  span.count("node", request.node);
  try {
    // The rest of a node is decoded behind the part in memory, which may have been evicted or replaced in the meantime.
    const NodeCache::Data before = request.from > 0 ? state_.cache.peek(request.node) : nullptr;
    if (leadingBytes(before) != request.from) {
      state_.queue.finish(request.node);
      state_.board.nodesChanged();
      return;
    }
    const bool withOccluders = state_.board.newest().selection.occlusion.enabled;
    if (decoder_.decode(request, bytes, before.get(), withOccluders, *buffer_) == DecodeResult::tooFewBytes) {
      tooShort_.push_back(request);
      return;
    }
    LoaderCounters::add(state_.counters.nodesLoaded, 1);
    LoaderCounters::add(state_.counters.pointsLoaded, buffer_->pointCount());
    if (request.ahead) LoaderCounters::add(state_.counters.nodesAhead, 1);
    state_.transfer.giveFilled({request.node, std::move(buffer_)});
    state_.board.loadEnded();
  } catch (const std::exception& error) {
    fail(request, error.what());
  }
}

void Loader::fail(const LoadRequest& request, const std::string& reason) {
  state_.failed.add(request.node, reason);
  state_.queue.finish(request.node);
  state_.board.nodesChanged();
  state_.board.loadEnded();
}

}  // namespace strata
