#include "lod/node_cache.h"

#include <algorithm>
#include <utility>

namespace strata {

NodeCache::NodeCache(std::uint64_t capacityBytes, std::span<const std::uint32_t> parents)
    : capacityBytes_(capacityBytes), parents_(parents) {}

NodeCache::Insertion NodeCache::insert(std::uint32_t node, std::shared_ptr<StreamedNode> data,
                                       std::vector<Released>& out) {
  const std::uint64_t bytes = data->memoryBytes();
  const MutexLock lock(mutex_);
  Entry* const present = find(node);
  if (present != nullptr && data->loadedPlanes() <= present->data->loadedPlanes() &&
      data->leadingBytes <= present->data->leadingBytes) {
    ++stats_.duplicates;
    out.push_back(std::move(data));
    return Insertion::duplicate;
  }
  if (!makeRoom(node, present, bytes, out)) {
    ++stats_.refusals;
    out.push_back(std::move(data));
    return Insertion::refused;
  }
  if (present != nullptr) {
    replaceData(node, *present, std::move(data), bytes, out);
    ++stats_.replaced;
    return Insertion::replaced;
  }
  addEntry(node, std::move(data), bytes);
  ++stats_.inserted;
  return Insertion::inserted;
}

void NodeCache::pin(std::span<const std::uint32_t> nodes, std::vector<Data>& found, std::vector<Pin>& pins) {
  found.assign(nodes.size(), nullptr);
  const MutexLock lock(mutex_);
  // Backwards, so that a node always counts as wanted more recently than those below it.
  for (std::size_t i = nodes.size(); i-- > 0;) {
    Entry* const entry = find(nodes[i]);
    if (entry == nullptr) continue;
    entry->order = ++order_;
    recency_.splice(recency_.begin(), recency_, entry->place);
    addPin(nodes[i], *entry);
    found[i] = entry->data;
    pins.push_back({nodes[i], entry->data.get()});
  }
}

void NodeCache::unpin(std::span<const Pin> pins, std::vector<Released>& out) {
  const MutexLock lock(mutex_);
  for (const Pin& pin : pins) {
    Entry* const entry = find(pin.node);
    if (entry != nullptr && entry->data.get() == pin.data) {
      dropPin(pin.node, *entry);
      continue;
    }
    const auto retired =
        std::find_if(retired_.begin(), retired_.end(), [&pin](const Retired& r) { return r.data.get() == pin.data; });
    if (retired == retired_.end() || --retired->pins > 0) continue;
    stats_.residentBytes -= retired->bytes;
    retiredBytes_ -= retired->bytes;
    out.push_back(std::move(retired->data));
    std::swap(*retired, retired_.back());
    retired_.pop_back();
  }
}

NodeCache::Data NodeCache::peek(std::uint32_t node) const {
  const MutexLock lock(mutex_);
  const auto found = entries_.find(node);
  return found != entries_.end() ? found->second.data : nullptr;
}

int NodeCache::loadedPlanes(std::uint32_t node) const {
  const MutexLock lock(mutex_);
  const auto found = entries_.find(node);
  return found != entries_.end() && found->second.data != nullptr ? found->second.data->loadedPlanes() : 0;
}

NodeCacheStats NodeCache::stats() const {
  const MutexLock lock(mutex_);
  return stats_;
}

NodeCache::Entry* NodeCache::find(std::uint32_t node) {
  const auto found = entries_.find(node);
  return found != entries_.end() && found->second.data != nullptr ? &found->second : nullptr;
}

NodeCache::Entry* NodeCache::parentEntry(std::uint32_t node) {
  const std::uint32_t parent = parents_[node];
  return parent < parents_.size() ? &entries_[parent] : nullptr;
}

void NodeCache::addPin(std::uint32_t node, Entry& entry) {
  const bool wasHeld = entry.held();
  ++entry.pins;
  if (!wasHeld) nowHeld(node, entry);
}

void NodeCache::dropPin(std::uint32_t node, Entry& entry) {
  --entry.pins;
  if (!entry.held()) nowFree(node, entry);
}

void NodeCache::nowHeld(std::uint32_t node, Entry& entry) {
  stats_.pinnedBytes += entry.bytes;
  Entry* const parent = parentEntry(node);
  if (parent == nullptr) return;
  const bool wasHeld = parent->held();
  ++parent->heldChildren;
  if (!wasHeld && parent->held()) nowHeld(parents_[node], *parent);
}

void NodeCache::nowFree(std::uint32_t node, Entry& entry) {
  stats_.pinnedBytes -= entry.bytes;
  Entry* const parent = parentEntry(node);
  if (parent == nullptr) return;
  const bool wasHeld = parent->held();
  --parent->heldChildren;
  if (wasHeld && !parent->held()) nowFree(parents_[node], *parent);
}

bool NodeCache::makeRoom(std::uint32_t node, Entry* present, std::uint64_t bytes, std::vector<Released>& out) {
  // Neither the node's poorer version nor, where there is none, its parent may give way: a pin keeps them.
  const std::uint32_t keptNode = present != nullptr ? node : parents_[node];
  Entry* const kept = present != nullptr ? present : keptNode < parents_.size() ? find(keptNode) : nullptr;
  const std::uint64_t leaving = present != nullptr && present->pins == 0 ? present->bytes : 0;
  if (kept != nullptr) addPin(keptNode, *kept);

  const std::uint64_t immovable = stats_.pinnedBytes + retiredBytes_ - leaving;
  const bool fits = bytes <= capacityBytes_ && immovable <= capacityBytes_ - bytes;
  if (fits) evictUntil(capacityBytes_ - bytes + leaving, out);

  if (kept != nullptr) dropPin(keptNode, *kept);
  return fits;
}

void NodeCache::evictUntil(std::uint64_t targetBytes, std::vector<Released>& out) {
  auto at = recency_.end();
  while (stats_.residentBytes > targetBytes && at != recency_.begin()) {
    std::uint32_t node = *--at;
    Entry* entry = find(node);
    if (!entry->evictable()) continue;
    ++at;
    // Ancestors that the scan passed over, because this child was resident, go right after it.
    const std::uint64_t scanned = entry->order;
    for (bool passed = true; passed && stats_.residentBytes > targetBytes && entry->evictable();) {
      const std::uint32_t parent = parents_[node];
      if (at == entry->place) ++at;
      evict(node, *entry, out);
      Entry* const above = parent < parents_.size() ? find(parent) : nullptr;
      passed = above != nullptr && above->order < scanned;
      node = parent;
      entry = above;
    }
  }
}

void NodeCache::evict(std::uint32_t node, Entry& entry, std::vector<Released>& out) {
  out.push_back(std::move(entry.data));
  stats_.residentBytes -= entry.bytes;
  --stats_.residentNodes;
  ++stats_.evictions;
  recency_.erase(entry.place);
  entries_.erase(node);
  Entry* const parent = parentEntry(node);
  if (parent == nullptr) return;
  --parent->residentChildren;
  if (parent->data == nullptr && parent->residentChildren == 0) entries_.erase(parents_[node]);
}

void NodeCache::addEntry(std::uint32_t node, std::shared_ptr<StreamedNode> data, std::uint64_t bytes) {
  Entry& entry = entries_[node];
  entry.data = std::move(data);
  entry.bytes = bytes;
  entry.order = ++order_;
  recency_.push_front(node);
  entry.place = recency_.begin();
  if (Entry* const parent = parentEntry(node)) ++parent->residentChildren;
  if (entry.held()) nowHeld(node, entry);  // through children that came before it
  addBytes(bytes);
  ++stats_.residentNodes;
}

void NodeCache::replaceData(std::uint32_t node, Entry& entry, std::shared_ptr<StreamedNode> data, std::uint64_t bytes,
                            std::vector<Released>& out) {
  std::shared_ptr<StreamedNode> old = std::exchange(entry.data, std::move(data));
  const bool wasHeld = entry.held();
  if (entry.pins > 0) {  // a list still draws the old version
    retired_.push_back({std::move(old), entry.bytes, std::exchange(entry.pins, 0)});
    retiredBytes_ += entry.bytes;
  } else {
    out.push_back(std::move(old));
    stats_.residentBytes -= entry.bytes;
  }
  if (wasHeld && !entry.held()) nowFree(node, entry);
  if (entry.held()) stats_.pinnedBytes += bytes - entry.bytes;
  entry.bytes = bytes;
  addBytes(bytes);
}

void NodeCache::addBytes(std::uint64_t bytes) {
  stats_.residentBytes += bytes;
  stats_.peakBytes = std::max(stats_.peakBytes, stats_.residentBytes);
}

}  // namespace strata
