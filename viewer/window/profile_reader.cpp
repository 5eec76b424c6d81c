#include "viewer/window/profile_reader.h"

#include <chrono>
#include <utility>

namespace strata {

void ProfileReader::ask(std::vector<std::shared_ptr<const Store>> stores, ProfileSlab slab, ProfileOptions options) {
  stop_.request_stop();
  if (answer_.valid()) answer_.wait();
  stop_ = {};
  found_ = 0;
  answer_ = std::async(std::launch::async,
                       [this, stop = stop_.get_token(), stores = std::move(stores), slab = std::move(slab), options] {
                         return readProfile(stores, slab, options, stop, &found_);
                       });
}

std::optional<Profile> ProfileReader::take() {
  if (!pending() || answer_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return std::nullopt;
  return answer_.get();
}

}  // namespace strata
