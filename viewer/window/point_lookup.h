#pragma once
#include <deque>
#include <future>
#include <memory>
#include <optional>
#include <string>

#include "viewer/tools/pick.h"

namespace strata {

/// Reads clicked points from their stores in a thread of its own, one after the other, so that no frame waits for the
/// disk. All members are for the render thread.
class PointLookup {
 public:
  struct Answer {
    PickedPoint point;
    std::string error;  ///< empty when all went well
  };

  /// Asks for the point number `point` of the node whose record has this index in the store's hierarchy.
  void ask(std::shared_ptr<const Store> store, std::uint32_t index, std::uint32_t point);
  /// True while questions are unanswered.
  bool pending() const { return answer_.valid(); }
  /// The next answer, once it has come; for once in each frame. Never waits.
  std::optional<Answer> take();

 private:
  struct Question {
    std::shared_ptr<const Store> store;
    std::uint32_t index;
    std::uint32_t point;
  };
  void askNext();

  std::deque<Question> waiting_;
  std::future<Answer> answer_;  ///< of the question being answered; its destructor waits for the end of the read
};

}  // namespace strata
