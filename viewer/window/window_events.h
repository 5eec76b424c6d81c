#pragma once
#include <bitset>
#include <cstdint>

#include <glm/glm.hpp>

#include "viewer/window/input_queue.h"
#include "viewer/window/key_bindings.h"

struct GLFWwindow;

namespace strata {

/// How many events a window has taken in since it was opened. A key or a button that goes down and up counts twice.
struct InputCounts {
  std::uint64_t keys = 0, buttons = 0, wheel = 0;
};

/// Mouse and keyboard of a window, frame by frame: GLFW's callbacks fill a queue, and each frame sees as much of it as
/// InputQueue allows. Dear ImGui gets the same events in the same frames.
class WindowEvents {
 public:
  /// Sets the callbacks of `window`, which must end before this object does. Dear ImGui must be set up already.
  explicit WindowEvents(GLFWwindow* window);
  WindowEvents(const WindowEvents&) = delete;
  WindowEvents& operator=(const WindowEvents&) = delete;

  /// Asks the window system for events, for up to `waitSeconds` where there are none, and takes those of the next
  /// frame.
  void beginFrame(double waitSeconds);
  /// Tells Dear ImGui the cursor and the buttons of this frame; between its backends' NewFrame() and its own.
  void placeMouse() const;

  // As of the present frame.
  const KeyboardState& keyboard() const { return keyboard_; }
  const glm::dvec2& cursor() const { return cursor_; }  ///< window units
  bool leftDoubleClicked() const { return leftDoubleClicked_; }
  /// True when events wait for the next frames.
  bool moreWaits() const { return !queue_.empty(); }
  const InputCounts& counts() const { return counts_; }

 private:
  static WindowEvents& of(GLFWwindow* window);
  void setCallbacks();
  void add(InputEvent event);
  void take(const InputEvent& event);

  GLFWwindow* const window_;
  InputQueue queue_;
  double askedAt_ = 0.0;  ///< GLFW's time, seconds, at which the window system was asked last
  KeyboardState keyboard_;
  glm::dvec2 cursor_{0.0};
  std::bitset<3> buttonsDown_;
  bool leftDoubleClicked_ = false;
  InputCounts counts_;
};

}  // namespace strata
