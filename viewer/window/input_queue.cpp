#include "viewer/window/input_queue.h"

#include <algorithm>

namespace strata {
namespace {

using Kind = InputEvent::Kind;

bool has(const std::vector<InputEvent>& frame, Kind kind) {
  return std::any_of(frame.begin(), frame.end(), [kind](const InputEvent& e) { return e.kind == kind; });
}

/// True when a frame that sees the events `frame` can see `event` too.
bool fits(const std::vector<InputEvent>& frame, const InputEvent& event) {
  switch (event.kind) {
    case Kind::cursor:
      return !has(frame, Kind::button) && !has(frame, Kind::wheel);
    case Kind::button:  // a drag reaches its end in one frame and is let go in the next
      return !has(frame, Kind::button) && !has(frame, Kind::wheel) && (event.down || !has(frame, Kind::cursor));
    case Kind::wheel:
      return !has(frame, Kind::button);
    case Kind::key:
      return std::none_of(frame.begin(), frame.end(), [&event](const InputEvent& e) {
        return e.kind == Kind::button || (e.kind == Kind::key && e.code == event.code);
      });
    case Kind::letter:
      return true;
  }
  return true;
}

}  // namespace

void InputQueue::add(InputEvent event) {
  if (event.kind == Kind::cursor) cursor_ = event.place;
  if (event.kind == Kind::button && event.down) {
    const InputEvent here{.place = cursor_, .code = event.code, .after = event.after, .before = event.before};
    // In slow frames the time of a click is known only roughly. Only clicks that were surely too far apart are single.
    event.doubleClick = firstClick_ && firstClick_->code == event.code &&
                        event.after - firstClick_->before < kDoubleClickSeconds &&
                        glm::distance(cursor_, firstClick_->place) < kDoubleClickDistance;
    firstClick_ = event.doubleClick ? std::nullopt : std::optional(here);
  }
  waiting_.push_back(event);
}

std::vector<InputEvent> InputQueue::takeFrame() {
  std::vector<InputEvent> frame;
  while (!waiting_.empty() && fits(frame, waiting_.front())) {
    frame.push_back(waiting_.front());
    waiting_.pop_front();
  }
  return frame;
}

}  // namespace strata
