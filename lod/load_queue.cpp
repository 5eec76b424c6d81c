#include "lod/load_queue.h"

#include <algorithm>

namespace strata {
namespace {

/// Ties go to the lower index, which in breadth-first order is the parent.
bool lessUrgent(const LoadRequest& a, const LoadRequest& b) {
  if (a.priority != b.priority) return a.priority < b.priority;
  return a.node > b.node;
}

}  // namespace

void LoadQueue::replace(std::vector<LoadRequest>& requests) {
  std::sort(requests.begin(), requests.end(), lessUrgent);
  {
    const std::lock_guard lock(mutex_);
    requests_.swap(requests);
  }
  changed_.notify_all();
  requests.clear();
}

LoadQueue::Iterator LoadQueue::mostUrgent() {
  const auto free = std::find_if(requests_.rbegin(), requests_.rend(), [this](const LoadRequest& request) {
    return std::find(inFlight_.begin(), inFlight_.end(), request.node) == inFlight_.end();
  });
  return free == requests_.rend() ? requests_.end() : std::prev(free.base());
}

std::optional<LoadRequest> LoadQueue::pop(std::stop_token stop) {
  std::unique_lock lock(mutex_);
  Iterator found = requests_.end();
  changed_.wait(lock, stop, [&] { return stopped_ || (found = mostUrgent()) != requests_.end(); });
  if (stopped_ || stop.stop_requested() || found == requests_.end()) return std::nullopt;
  const LoadRequest request = *found;
  requests_.erase(found);
  inFlight_.push_back(request.node);
  return request;
}

void LoadQueue::removeFromFlight(std::uint32_t node) {
  const auto found = std::find(inFlight_.begin(), inFlight_.end(), node);
  if (found == inFlight_.end()) return;
  *found = inFlight_.back();
  inFlight_.pop_back();
}

void LoadQueue::finish(std::uint32_t node) {
  const std::lock_guard lock(mutex_);
  removeFromFlight(node);
  std::erase_if(requests_, [node](const LoadRequest& request) { return request.node == node; });
}

void LoadQueue::release(std::uint32_t node) {
  {
    const std::lock_guard lock(mutex_);
    removeFromFlight(node);
  }
  changed_.notify_all();
}

void LoadQueue::stop() {
  {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
  }
  changed_.notify_all();
}

std::size_t LoadQueue::size() const {
  const std::lock_guard lock(mutex_);
  return requests_.size();
}

std::size_t LoadQueue::inFlight() const {
  const std::lock_guard lock(mutex_);
  return inFlight_.size();
}

}  // namespace strata
