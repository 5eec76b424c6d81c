#include "viewer/window/point_lookup.h"

#include <chrono>
#include <exception>
#include <utility>

namespace strata {

void PointLookup::ask(std::shared_ptr<const Store> store, std::uint32_t index, std::uint32_t point) {
  waiting_.push_back({std::move(store), index, point});
  if (!pending()) askNext();
}

void PointLookup::askNext() {
  if (waiting_.empty()) return;
  answer_ = std::async(std::launch::async, [question = std::move(waiting_.front())] {
    Answer answer;
    try {
      answer.point = lookUpPoint(*question.store, question.index, question.point);
    } catch (const std::exception& error) {
      answer.error = error.what();
    }
    return answer;
  });
  waiting_.pop_front();
}

std::optional<PointLookup::Answer> PointLookup::take() {
  if (!pending() || answer_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return std::nullopt;
  Answer answer = answer_.get();
  askNext();
  return answer;
}

}  // namespace strata
