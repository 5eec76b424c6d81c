#pragma once
#include <cstdint>
#include <mutex>
#include <string>
#include <unordered_map>

namespace strata {

/// Nodes that could not be read or decoded, and how often that was tried. Written by loaders, read by the LOD thread.
class FailedNodes {
 public:
  /// Tries before a node is given up; its parent then stands in for good.
  static constexpr int kMaxAttempts = 3;
  /// Nodes that are named in the log; the rest are only counted.
  static constexpr int kMaxLogged = 20;

  /// Counts a failed try and logs the node's first.
  void add(std::uint32_t node, const std::string& reason);

  /// Replaces `attempts` (tries by node) if anything was added since `version`, which is brought up to date.
  void copyIfNewer(std::unordered_map<std::uint32_t, int>& attempts, std::uint64_t& version) const;

  std::uint64_t failures() const;  ///< all failed tries
  /// True when no further attempt is to be made.
  bool outOfTries(std::uint32_t node) const;
  std::uint64_t givenUp() const;   ///< nodes out of tries

 private:
  // Guarded by mutex_.
  mutable std::mutex mutex_;
  std::unordered_map<std::uint32_t, int> attempts_;
  std::uint64_t failures_ = 0;
  std::uint64_t givenUp_ = 0;
};

}  // namespace strata
