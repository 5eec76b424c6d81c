#pragma once
#include <deque>
#include <optional>
#include <vector>

#include <glm/glm.hpp>

namespace strata {

/// One thing that the user did with mouse or keyboard. Codes are the window system's own.
struct InputEvent {
  enum class Kind { cursor, button, wheel, key, letter };
  Kind kind = Kind::cursor;
  glm::dvec2 place{0.0};     ///< of the cursor, window units; the notches of a wheel
  int code = 0;              ///< button, key or letter
  int scancode = 0;          ///< of a key
  bool down = false;         ///< the button or the key goes down, not up
  bool repeated = false;     ///< the key went down before and is held
  int modifiers = 0;         ///< of a key
  double after = 0.0;        ///< seconds: the last time at which the window system did not know of the event
  double before = 0.0;       ///< seconds: the first time at which it did
  bool doubleClick = false;  ///< the button goes down for a double click; InputQueue sets it
};

/// Spreads events over frames, so that no frame misses one. A frame knows only whether a button is down and where the
/// cursor is; when a button goes down and up during one slow frame, the queue therefore shows it down in one frame and
/// up in the next, with the cursor where it was at each of the two. Events that do not hide each other come together.
class InputQueue {
 public:
  static constexpr double kDoubleClickSeconds = 0.3;
  static constexpr double kDoubleClickDistance = 6.0;  ///< window units between the two clicks, at most

  void add(InputEvent event);
  /// Removes the events of the next frame and returns them in their order. Not empty unless the queue is.
  std::vector<InputEvent> takeFrame();
  bool empty() const { return waiting_.empty(); }

 private:
  std::deque<InputEvent> waiting_;
  glm::dvec2 cursor_{0.0};                ///< after the newest event
  std::optional<InputEvent> firstClick_;  ///< a click that another may make a double click; its place is the cursor's
};

}  // namespace strata
