#pragma once
#include <atomic>
#include <future>
#include <memory>
#include <optional>
#include <stop_token>
#include <vector>

#include "viewer/tools/profile.h"

namespace strata {

/// Reads one profile at a time, beside the frames. For the render thread.
class ProfileReader {
 public:
  ~ProfileReader() { stop_.request_stop(); }

  /// Begins to read; what is on its way is given up first.
  void ask(std::vector<std::shared_ptr<const Store>> stores, ProfileSlab slab, ProfileOptions options);
  bool pending() const { return answer_.valid(); }
  /// Points so far, of the profile that is on its way.
  std::uint64_t found() const { return found_.load(std::memory_order_relaxed); }
  /// Once a frame: the profile, when it is there.
  std::optional<Profile> take();

 private:
  std::atomic<std::uint64_t> found_{0};
  std::stop_source stop_;
  std::future<Profile> answer_;  ///< its destructor waits for the node that is being read
};

}  // namespace strata
