#include "lod/load_queue.h"

#include <algorithm>

namespace strata {
namespace {

/// Of two equal priorities the lower index is more urgent: in breadth-first order it is the parent.
bool lessUrgent(const LoadRequest& a, const LoadRequest& b) {
  if (a.ahead != b.ahead) return a.ahead;
  if (a.priority != b.priority) return a.priority < b.priority;
  return a.node > b.node;
}

}  // namespace

void LoadQueue::replace(std::vector<LoadRequest>& requests) {
  std::sort(requests.begin(), requests.end(), lessUrgent);
  {
    const MutexLock lock(mutex_);
    requests_.swap(requests);
  }
  changed_.notify_all();
  requests.clear();
}

LoadQueue::Iterator LoadQueue::mostUrgent() {
  const auto free =
      std::find_if(requests_.rbegin(), requests_.rend(),
                   [this](const LoadRequest& request) STRATA_REQUIRES(mutex_) { return !isInFlight(request.node); });
  return free == requests_.rend() ? requests_.end() : std::prev(free.base());
}

bool LoadQueue::isInFlight(std::uint32_t node) const {
  return std::find(inFlight_.begin(), inFlight_.end(), node) != inFlight_.end();
}

LoadRequest LoadQueue::take(Iterator request) {
  const LoadRequest taken = *request;
  requests_.erase(request);
  inFlight_.push_back(taken.node);
  return taken;
}

std::optional<LoadRequest> LoadQueue::pop(std::stop_token stop) {
  std::vector<LoadRequest> one;
  pop(stop, {}, one);
  return one.empty() ? std::nullopt : std::optional(one.front());
}

void LoadQueue::pop(std::stop_token stop, const ReadLimits& limits, std::vector<LoadRequest>& out) {
  out.clear();
  const MutexLock lock(mutex_);
  Iterator found = requests_.end();
  changed_.wait(mutex_, stop,
                [&]() STRATA_REQUIRES(mutex_) { return stopped_ || (found = mostUrgent()) != requests_.end(); });
  if (stopped_ || stop.stop_requested() || found == requests_.end()) return;
  out.push_back(take(found));
  // Grows the range on either side, by what lies nearest, until nothing near enough is left.
  const float least = out.front().priority * limits.leastPriority;
  while (out.size() < limits.nodes && !out.front().alone) {
    const Iterator next = nextTo(out.front(), out.back(), limits, least);
    if (next == requests_.end()) break;
    const bool before = next->offset < out.front().offset;
    out.insert(before ? out.begin() : out.end(), take(next));
  }
}

LoadQueue::Iterator LoadQueue::nextTo(const LoadRequest& first, const LoadRequest& last, const ReadLimits& limits,
                                      float leastPriority) {
  const std::uint64_t begin = first.offset, end = last.offset + last.bytes;
  Iterator nearest = requests_.end();
  std::uint64_t nearestGap = limits.gap;
  for (Iterator request = requests_.begin(); request != requests_.end(); ++request) {
    const std::uint64_t requestEnd = request->offset + request->bytes;
    if (request->offset < end && requestEnd > begin) continue;  // the range brings it already
    const std::uint64_t gap = request->offset >= end ? request->offset - end : begin - requestEnd;
    const std::uint64_t whole = std::max(end, requestEnd) - std::min(begin, request->offset);
    if (gap > nearestGap || static_cast<float>(gap) > limits.waste * static_cast<float>(request->bytes)) continue;
    if (request->ahead != first.ahead || request->alone || request->priority < leastPriority) continue;
    if (whole > limits.bytes || isInFlight(request->node)) continue;
    nearest = request;
    nearestGap = gap;
  }
  return nearest;
}

void LoadQueue::removeFromFlight(std::uint32_t node) {
  const auto found = std::find(inFlight_.begin(), inFlight_.end(), node);
  if (found == inFlight_.end()) return;
  *found = inFlight_.back();
  inFlight_.pop_back();
}

void LoadQueue::finish(std::uint32_t node) {
  const MutexLock lock(mutex_);
  removeFromFlight(node);
  std::erase_if(requests_, [node](const LoadRequest& request) { return request.node == node; });
}

void LoadQueue::release(std::uint32_t node) {
  {
    const MutexLock lock(mutex_);
    removeFromFlight(node);
  }
  changed_.notify_all();
}

void LoadQueue::putBack(const LoadRequest& request) {
  {
    const MutexLock lock(mutex_);
    removeFromFlight(request.node);
    const bool renewed = std::any_of(requests_.begin(), requests_.end(),
                                     [&](const LoadRequest& other) { return other.node == request.node; });
    if (!renewed) requests_.insert(std::lower_bound(requests_.begin(), requests_.end(), request, lessUrgent), request);
  }
  changed_.notify_all();
}

void LoadQueue::stop() {
  {
    const MutexLock lock(mutex_);
    stopped_ = true;
  }
  changed_.notify_all();
}

std::size_t LoadQueue::size() const {
  const MutexLock lock(mutex_);
  return requests_.size();
}

std::size_t LoadQueue::inFlight() const {
  const MutexLock lock(mutex_);
  return inFlight_.size();
}

}  // namespace strata
