#pragma once
#include <cstdint>
#include <memory>
#include <string>

#include <glm/glm.hpp>

#include "render/gl/gl_context.h"
#include "viewer/camera/camera_control.h"
#include "viewer/window/item_positions.h"

namespace strata {

/// What happened since the last frame. Pixels of the framebuffer, origin at the top left. What the user did inside
/// the panel is not in here.
struct WindowInput {
  int width = 0, height = 0;
  double seconds = 0.0;  ///< since the last frame
  glm::dvec2 cursor{0.0};
  bool leftPressed = false;  ///< went down in this frame
  bool rightPressed = false;
  bool dragging = false;                          ///< a button is down
  double wheel = 0.0;                             ///< notches, positive away from the user
  FlyInput fly;                                   ///< W A S D, E and Q for up and down, shift
  bool frameAll = false;                          ///< F
  bool front = false, side = false, top = false;  ///< 1, 3, 7
  bool orthographic = false;                      ///< O: with perspective or without
  bool clicked = false;                           ///< left button let go where it went down
  bool doubleClicked = false;
  bool keep = false, takeBack = false, drop = false;   ///< Enter, Backspace, Escape
  bool save = false;                                   ///< Control + S
  bool measure = false;                                ///< M: a distance
  bool profile = false;                                ///< X: a cross-section
  bool clipBox = false;                                ///< B: a new clip box
  bool help = false;                                   ///< H or F1
  bool takePicture = false;                            ///< Control + P
  bool pictures = false;                               ///< P: the window for pictures and paths
  bool pathKey = false, record = false, play = false;  ///< K, R, space
  bool nextMode = false;                               ///< G: the next way of moving
  bool hidden = false;                                 ///< minimised, or not on the screen: nothing need be drawn

  bool moreWaits = false;  ///< for the next frames: see InputQueue

  /// Nothing that changes the picture.
  bool idle() const {
    return !dragging && !leftPressed && !rightPressed && wheel == 0.0 && fly.still() && !frameAll && !front && !side &&
           !top && !orthographic && !clicked && !doubleClicked && !keep && !takeBack && !drop && !save && !measure &&
           !profile && !clipBox && !help && !pictures && !takePicture && !pathKey && !record && !play && !nextMode &&
           !moreWaits;
  }
};

/// What the window has taken in since it was opened, as numbers of events: a key or a button goes down, or up.
struct InputCounts {
  std::uint64_t keys = 0, buttons = 0, wheel = 0;
};

/// A window with an OpenGL context, current in the thread that makes it, and Dear ImGui in it. There is one at a time.
class Window {
 public:
  /// Throws Error when there is no display or no OpenGL. A hidden window still draws.
  Window(const std::string& title, int width, int height, bool visible);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  bool closed() const;
  /// Takes in what happened and begins a frame of the panel. Where nothing does, waits up to `waitSeconds`.
  WindowInput beginFrame(double waitSeconds);
  /// The mouse is over a panel or a text is typed: what is drawn may change with every event.
  bool panelInUse() const;
  const InputCounts& inputCounts() const;
  bool focused() const;
  glm::dvec2 cursor() const;  ///< window units
  const ItemPositions& itemPositions() const;
  /// Puts a texture behind everything.
  void drawPicture(unsigned texture);
  /// Draws the panel into the back buffer.
  void finishFrame();
  void present();

  static GlContext::GetProc getProc();

 private:
  struct Parts;  // GLFW's and ImGui's own
  std::unique_ptr<Parts> parts_;
};

}  // namespace strata
