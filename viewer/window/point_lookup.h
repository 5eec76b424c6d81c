#pragma once
#include <deque>
#include <future>
#include <memory>
#include <optional>
#include <string>

#include "viewer/tools/pick.h"

namespace strata {

/// Asks the disk about one clicked point at a time, beside the frames.
class PointLookup {
 public:
  struct Answer {
    PickedPoint point;
    std::string error;  ///< empty when all went well
  };

  /// Render thread. Questions are answered one after the other.
  void ask(std::shared_ptr<const Store> store, NodeKey node, std::uint32_t point, const glm::dvec3& drawnAt);
  bool pending() const { return answer_.valid(); }
  /// Render thread, once a frame: the answer, when it has come.
  std::optional<Answer> take();

 private:
  struct Question {
    std::shared_ptr<const Store> store;
    NodeKey node;
    std::uint32_t point;
    glm::dvec3 drawnAt;
  };
  void askNext();

  std::deque<Question> waiting_;
  std::future<Answer> answer_;  ///< its destructor waits for the one read that may be on its way
};

}  // namespace strata
