#include "viewer/window/point_lookup.h"

#include <chrono>
#include <exception>
#include <utility>

namespace strata {

bool PointLookup::ask(std::shared_ptr<const Store> store, NodeKey node, std::uint32_t point,
                      const glm::dvec3& drawnAt) {
  if (pending()) return false;
  answer_ = std::async(std::launch::async, [store = std::move(store), node, point, drawnAt] {
    Answer answer;
    try {
      answer.point = lookUpPoint(*store, node, point, drawnAt);
    } catch (const std::exception& error) {
      answer.error = error.what();
    }
    return answer;
  });
  return true;
}

std::optional<PointLookup::Answer> PointLookup::take() {
  if (!pending() || answer_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return std::nullopt;
  return answer_.get();
}

}  // namespace strata
