#include "lod/failed_nodes.h"

#include "core/log.h"

namespace strata {

void FailedNodes::add(std::uint32_t node, const std::string& reason) {
  bool first = false;
  std::size_t nodes = 0;
  {
    const MutexLock lock(mutex_);
    Failure& failure = byNode_[node];
    first = failure.attempts == 0;
    auto wait = firstRetry_;
    for (int i = 0; i < failure.attempts; ++i) wait *= kBackOff;
    failure.retryAt = Clock::now() + wait;
    ++failure.attempts;
    ++failures_;
    if (failure.attempts == kMaxAttempts) ++givenUp_;
    nodes = byNode_.size();
  }
  if (!first || nodes > kMaxLogged) return;
  logWarning(reason);
  if (nodes == kMaxLogged) logWarning("more nodes that fail to load are counted, but not named");
}

void FailedNodes::copyIfNewer(ByNode& failures, std::uint64_t& version) const {
  const MutexLock lock(mutex_);
  if (version == failures_) return;
  version = failures_;
  failures = byNode_;
}

std::uint64_t FailedNodes::failures() const {
  const MutexLock lock(mutex_);
  return failures_;
}

bool FailedNodes::mustWait(std::uint32_t node) const {
  const MutexLock lock(mutex_);
  const auto found = byNode_.find(node);
  return found != byNode_.end() && found->second.mustWait(Clock::now());
}

std::uint64_t FailedNodes::givenUp() const {
  const MutexLock lock(mutex_);
  return givenUp_;
}

}  // namespace strata
