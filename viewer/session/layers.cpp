#include "viewer/session/layers.h"

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
  merged.coarseNodes += list.coarseNodes;
  merged.serial += list.serial;
}

Layers::Layers(std::vector<std::shared_ptr<const Store>> stores, const StreamerOptions& options)
    : stores_(std::move(stores)), shown_(stores_.size(), true), selection_(options.selection) {
  StreamerOptions each = options;
  each.selection = shareOf(options.selection, stores_.size());
  each.cacheBytes = options.cacheBytes / std::max<std::size_t>(stores_.size(), 1);
  for (const auto& store : stores_) streamers_.push_back(std::make_unique<Streamer>(store, each));
}

void Layers::setShown(const std::vector<bool>& shown) {
  shown_ = shown;
  shown_.resize(stores_.size(), true);
  setSelection(selection_);
  if (view_) setView(*view_);
}

void Layers::setView(const View& view, const View& ahead) {
  view_ = view;
  for (std::size_t i = 0; i < streamers_.size(); ++i)
    if (shown_[i]) streamers_[i]->setView(view, ahead);
}

void Layers::setView(const View& view) {
  view_ = view;
  for (std::size_t i = 0; i < streamers_.size(); ++i)
    if (shown_[i]) streamers_[i]->setView(view);
}

void Layers::setSelection(const SelectionOptions& selection) {
  selection_ = selection;
  const auto drawn = static_cast<std::size_t>(std::count(shown_.begin(), shown_.end(), true));
  for (std::size_t i = 0; i < streamers_.size(); ++i)
    if (shown_[i]) streamers_[i]->setSelection(shareOf(selection, drawn));
}

const RenderList& Layers::beginFrame() {
  itemEnds_.clear();
  if (streamers_.size() == 1 && shown_[0]) {
    const RenderList& list = streamers_.front()->beginFrame();
    itemEnds_.push_back(list.items.size());
    return list;
  }
  // Let go of the old nodes first: a streamer frees what it evicted only once nobody else holds it.
  if (view_) merged_.view = *view_;
  merged_.items.clear();
  merged_.pointCount = 0;
  merged_.missingNodes = 0;
  merged_.coarseNodes = 0;
  merged_.serial = 0;
  for (std::size_t i = 0; i < streamers_.size(); ++i) {
    if (shown_[i]) appendList(streamers_[i]->beginFrame(), merged_);
    itemEnds_.push_back(merged_.items.size());
  }
  return merged_;
}

std::size_t Layers::indexOfItem(std::size_t item) const {
  const auto end = std::upper_bound(itemEnds_.begin(), itemEnds_.end(), item);
  return std::min(static_cast<std::size_t>(end - itemEnds_.begin()), stores_.size() - 1);
}

bool Layers::complete() const {
  for (std::size_t i = 0; i < streamers_.size(); ++i)
    if (shown_[i] && !streamers_[i]->complete()) return false;
  return true;
}

bool Layers::waitUntilComplete(std::chrono::milliseconds timeout) {
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  merged_.items.clear();
  bool whole = true;
  for (std::size_t i = 0; i < streamers_.size(); ++i) {
    if (!shown_[i]) continue;
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
    whole = streamers_[i]->waitUntilComplete(std::max(left, std::chrono::milliseconds(0))) && whole;
  }
  return whole;
}

void Layers::coarseDepth(std::vector<float>& depths) const {
  const auto shown = std::find(shown_.begin(), shown_.end(), true);
  depths.clear();
  if (shown != shown_.end()) streamers_[static_cast<std::size_t>(shown - shown_.begin())]->copyCoarseDepth(depths);
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
    sum.overCapacity += s.overCapacity;
    sum.queueLength += s.queueLength;
    sum.residentBytes += s.residentBytes;
    sum.residentNodes += s.residentNodes;
    sum.lodMs = std::max(sum.lodMs, s.lodMs);
  }
  return sum;
}

}  // namespace strata
