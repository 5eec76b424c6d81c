#include "viewer/layers.h"

#include <algorithm>
#include <utility>

namespace strata {
namespace {

SelectionOptions shareOf(SelectionOptions selection, std::size_t layers) {
  selection.pointBudget = std::max<std::uint64_t>(1, selection.pointBudget / std::max<std::size_t>(layers, 1));
  return selection;
}

}  // namespace

void appendList(const RenderList& list, RenderList& merged) {
  merged.view = list.view;
  merged.items.insert(merged.items.end(), list.items.begin(), list.items.end());
  merged.pointCount += list.pointCount;
  merged.missingNodes += list.missingNodes;
  merged.serial += list.serial;
}

Layers::Layers(std::vector<std::shared_ptr<const Store>> stores, const StreamerOptions& options)
    : stores_(std::move(stores)) {
  StreamerOptions each = options;
  each.selection = shareOf(options.selection, stores_.size());
  each.cacheBytes = options.cacheBytes / std::max<std::size_t>(stores_.size(), 1);
  for (const auto& store : stores_) streamers_.push_back(std::make_unique<Streamer>(store, each));
}

void Layers::setView(const View& view) {
  for (const auto& streamer : streamers_) streamer->setView(view);
}

void Layers::setSelection(const SelectionOptions& selection) {
  for (const auto& streamer : streamers_) streamer->setSelection(shareOf(selection, stores_.size()));
}

const RenderList& Layers::beginFrame() {
  if (streamers_.size() == 1) return streamers_.front()->beginFrame();
  // Let go of the old nodes first: a streamer frees what it evicted only once nobody else holds it.
  merged_.items.clear();
  merged_.pointCount = 0;
  merged_.missingNodes = 0;
  merged_.serial = 0;
  for (const auto& streamer : streamers_) appendList(streamer->beginFrame(), merged_);
  return merged_;
}

bool Layers::complete() const {
  return std::all_of(streamers_.begin(), streamers_.end(), [](const auto& s) { return s->complete(); });
}

bool Layers::waitUntilComplete(std::chrono::milliseconds timeout) {
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  merged_.items.clear();
  bool whole = true;
  for (const auto& streamer : streamers_) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
    whole = streamer->waitUntilComplete(std::max(left, std::chrono::milliseconds(0))) && whole;
  }
  return whole;
}

StreamerStats Layers::stats() const {
  StreamerStats sum;
  for (const auto& streamer : streamers_) {
    const StreamerStats s = streamer->stats();
    sum.nodesLoaded += s.nodesLoaded;
    sum.bytesRead += s.bytesRead;
    sum.failures += s.failures;
    sum.nodesGivenUp += s.nodesGivenUp;
    sum.cacheHits += s.cacheHits;
    sum.cacheMisses += s.cacheMisses;
    sum.evictions += s.evictions;
    sum.refusals += s.refusals;
    sum.queueLength += s.queueLength;
    sum.residentBytes += s.residentBytes;
    sum.residentNodes += s.residentNodes;
    sum.lodMs = std::max(sum.lodMs, s.lodMs);
  }
  return sum;
}

}  // namespace strata
