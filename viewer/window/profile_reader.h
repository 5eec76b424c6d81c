#pragma once
#include <atomic>
#include <future>
#include <memory>
#include <optional>
#include <stop_token>
#include <vector>

#include "viewer/tools/profile.h"

namespace strata {

/// Reads a profile from the stores in a thread of its own, so that no frame waits for the disk. All members are for the
/// render thread.
class ProfileReader {
 public:
  ~ProfileReader() { stop_.request_stop(); }

  /// Begins to read. Stops reading the profile that was asked for before, and waits for that.
  void ask(std::vector<std::shared_ptr<const Store>> stores, ProfileSlab slab, ProfileOptions options);
  /// True while a profile is being read.
  bool pending() const { return answer_.valid(); }
  /// The number of points that the profile has so far.
  std::uint64_t found() const { return found_.load(std::memory_order_relaxed); }
  /// The profile, once it has been read; for once in each frame. Never waits.
  std::optional<Profile> take();

 private:
  std::atomic<std::uint64_t> found_{0};  ///< written by the reading thread
  std::stop_source stop_;
  std::future<Profile> answer_;  ///< its destructor waits for the node that is being read
};

}  // namespace strata
