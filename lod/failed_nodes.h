#pragma once
#include <chrono>
#include <cstdint>
#include <string>
#include <unordered_map>

#include "core/mutex.h"

namespace strata {

/// Nodes that could not be read or decoded, how often that was tried, and when they may be tried again. Loaders write
/// it; they and the LOD thread read it.
class FailedNodes {
 public:
  using Clock = std::chrono::steady_clock;

  /// Tries before a node is given up. Its parent is drawn in its place from then on.
  static constexpr int kMaxAttempts = 3;
  /// How many nodes are named in the log; the rest are only counted.
  static constexpr int kMaxLogged = 20;
  /// Each wait for the next try is this many times the one before.
  static constexpr int kBackOff = 4;

  struct Failure {
    int attempts = 0;
    Clock::time_point retryAt;  ///< without meaning when out of tries

    bool outOfTries() const { return attempts >= kMaxAttempts; }
    bool mustWait(Clock::time_point now) const { return now < retryAt || outOfTries(); }
  };
  using ByNode = std::unordered_map<std::uint32_t, Failure>;

  /// `firstRetry` is the wait after a node's first failure.
  explicit FailedNodes(std::chrono::milliseconds firstRetry) : firstRetry_(firstRetry) {}

  /// Counts a failed try and logs the node's first.
  void add(std::uint32_t node, const std::string& reason);

  /// Replaces `failures` and `version` when a failure was added since `version`.
  void copyIfNewer(ByNode& failures, std::uint64_t& version) const;

  std::uint64_t failures() const;  ///< all failed tries
  /// True when the node may not be tried now, or ever again.
  bool mustWait(std::uint32_t node) const;
  std::uint64_t givenUp() const;  ///< nodes out of tries

 private:
  // Constant after construction.
  const std::chrono::milliseconds firstRetry_;

  mutable Mutex mutex_;
  ByNode byNode_ STRATA_GUARDED_BY(mutex_);
  std::uint64_t failures_ STRATA_GUARDED_BY(mutex_) = 0;
  std::uint64_t givenUp_ STRATA_GUARDED_BY(mutex_) = 0;
};

}  // namespace strata
