#include "lod/failed_nodes.h"

#include "core/log.h"

namespace strata {

void FailedNodes::add(std::uint32_t node, const std::string& reason) {
  bool first = false;
  std::size_t nodes = 0;
  {
    const std::lock_guard lock(mutex_);
    int& attempts = attempts_[node];
    first = attempts == 0;
    ++attempts;
    ++failures_;
    if (attempts == kMaxAttempts) ++givenUp_;
    nodes = attempts_.size();
  }
  if (!first || nodes > kMaxLogged) return;
  logWarning(reason);
  if (nodes == kMaxLogged) logWarning("more nodes that fail to load are counted, but not named");
}

void FailedNodes::copyIfNewer(std::unordered_map<std::uint32_t, int>& attempts, std::uint64_t& version) const {
  const std::lock_guard lock(mutex_);
  if (version == failures_) return;
  version = failures_;
  attempts = attempts_;
}

std::uint64_t FailedNodes::failures() const {
  const std::lock_guard lock(mutex_);
  return failures_;
}

bool FailedNodes::outOfTries(std::uint32_t node) const {
  const std::lock_guard lock(mutex_);
  const auto found = attempts_.find(node);
  return found != attempts_.end() && found->second >= kMaxAttempts;
}

std::uint64_t FailedNodes::givenUp() const {
  const std::lock_guard lock(mutex_);
  return givenUp_;
}

}  // namespace strata
