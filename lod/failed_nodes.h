#pragma once
#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>
#include <unordered_map>

namespace strata {

/// Nodes that could not be read or decoded, how often that was tried, and when they may be tried again. Written by
/// loaders, read by the LOD thread.
class FailedNodes {
 public:
  using Clock = std::chrono::steady_clock;

  /// Tries before a node is given up; its parent then stands in for good.
  static constexpr int kMaxAttempts = 3;
  /// Nodes that are named in the log; the rest are only counted.
  static constexpr int kMaxLogged = 20;
  /// Each wait for the next try is so many times the last.
  static constexpr int kBackOff = 4;

  struct Failure {
    int attempts = 0;
    Clock::time_point retryAt;  ///< of no meaning when out of tries

    bool outOfTries() const { return attempts >= kMaxAttempts; }
    bool mustWait(Clock::time_point now) const { return now < retryAt || outOfTries(); }
  };
  using ByNode = std::unordered_map<std::uint32_t, Failure>;

  /// `firstRetry` is the wait after a node's first failure.
  explicit FailedNodes(std::chrono::milliseconds firstRetry) : firstRetry_(firstRetry) {}

  /// Counts a failed try and logs the node's first.
  void add(std::uint32_t node, const std::string& reason);

  /// Replaces `failures` if anything was added since `version`, which is brought up to date.
  void copyIfNewer(ByNode& failures, std::uint64_t& version) const;

  std::uint64_t failures() const;  ///< all failed tries
  /// True when the node is not to be tried, now or ever.
  bool mustWait(std::uint32_t node) const;
  std::uint64_t givenUp() const;  ///< nodes out of tries

 private:
  const std::chrono::milliseconds firstRetry_;

  // Guarded by mutex_.
  mutable std::mutex mutex_;
  ByNode byNode_;
  std::uint64_t failures_ = 0;
  std::uint64_t givenUp_ = 0;
};

}  // namespace strata
