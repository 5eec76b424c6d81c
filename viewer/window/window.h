#pragma once
#include <memory>
#include <string>

#include <glm/glm.hpp>

#include "render/gl/gl_context.h"
#include "viewer/camera/camera_control.h"
#include "viewer/window/item_positions.h"
#include "viewer/window/key_bindings.h"
#include "viewer/window/window_events.h"

namespace strata {

/// What the mouse did over the picture since the last frame; over a panel only `dragging` is told.
struct MouseInput {
  bool leftPressed = false;  ///< went down in this frame
  bool rightPressed = false;
  bool dragging = false;       ///< a button is down
  bool clicked = false;        ///< the left button was let go near where it went down
  bool doubleClicked = false;  ///< the left button
  double wheel = 0.0;          ///< notches, positive away from the user

  bool operator==(const MouseInput&) const = default;
};

/// What happened since the last frame. What the user did inside the panels is not in here.
struct WindowInput {
  int width = 0, height = 0;  ///< of the framebuffer, pixels
  double seconds = 0.0;       ///< since the last frame
  glm::dvec2 cursor{0.0};     ///< pixels of the framebuffer, origin at the top left
  MouseInput mouse;
  CommandSet commands;
  FlyInput fly;            ///< the keys that are held down
  bool hidden = false;     ///< the window is minimised or not on the screen: nothing need be drawn
  bool moreWaits = false;  ///< events wait for the next frames, see InputQueue

  bool has(Command command) const { return commands.has(command); }
  /// True when nothing happened that changes the picture, and nothing waits that will.
  bool idle() const { return commands.none() && mouse == MouseInput{} && fly.still() && !moreWaits; }
};

/// A window with an OpenGL context, current in the thread that makes it, and Dear ImGui in it. There is one at a time.
/// Each frame is beginFrame(), then drawing, finishFrame(), and present() where the frame is to be seen.
class Window {
 public:
  /// Throws Error when there is no display or no OpenGL. A window that is not `visible` still draws.
  Window(const std::string& title, int width, int height, bool visible);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// True once the user has closed the window or has quit.
  bool closed() const;
  /// Takes in what happened and begins a frame of the panels. Waits up to `waitSeconds` for something to happen.
  WindowInput beginFrame(double waitSeconds);
  /// True while an item of a panel is held or a text is typed: the panels may then change with every event.
  bool panelInUse() const;
  const InputCounts& inputCounts() const;
  bool focused() const;
  glm::dvec2 cursor() const;  ///< window units
  const ItemPositions& itemPositions() const;
  /// Draws a texture, by OpenGL's number, behind everything else.
  void drawPicture(unsigned texture);
  /// Draws the picture and the panels into the back buffer.
  void finishFrame();
  /// Shows the back buffer.
  void present();

  static GlContext::GetProc getProc();

 private:
  struct Parts;  // of GLFW and Dear ImGui, whose headers stay out of ours
  std::unique_ptr<Parts> parts_;
};

}  // namespace strata
