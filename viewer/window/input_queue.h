#pragma once
#include <deque>
#include <optional>
#include <vector>

#include <glm/glm.hpp>

namespace strata {

/// One thing a hand did, as the window system told it. Codes are the window system's own.
struct InputEvent {
  enum class Kind { cursor, button, wheel, key, letter };
  Kind kind = Kind::cursor;
  glm::dvec2 place{0.0};     ///< of the cursor, window units; of a wheel: its notches
  int code = 0;              ///< button, key or letter
  int scancode = 0;          ///< of a key
  bool down = false;         ///< of a button or a key: goes down
  bool repeated = false;     ///< a key that is held down says so again
  int modifiers = 0;         ///< of a key
  double after = 0.0;        ///< seconds: the window system had been asked then and did not know of it,
  double before = 0.0;       ///< and then it did
  bool doubleClick = false;  ///< of a button going down; InputQueue says so
};

/// What a hand does within one frame, spread over as many frames as it takes for each to see one thing: a button that
/// goes down and up within a slow frame does so in two, and the cursor stays where it was pressed until then. All that
/// a frame can see at once comes at once.
class InputQueue {
 public:
  static constexpr double kDoubleClickSeconds = 0.3;
  static constexpr double kDoubleClickPlace = 6.0;  ///< window units between the two clicks

  void add(InputEvent event);
  /// The events of the next frame, in their order.
  std::vector<InputEvent> takeFrame();
  bool empty() const { return waiting_.empty(); }

 private:
  std::deque<InputEvent> waiting_;
  glm::dvec2 cursor_{0.0};                ///< after the last event added
  std::optional<InputEvent> firstClick_;  ///< that a second may follow; place is the cursor's
};

}  // namespace strata
