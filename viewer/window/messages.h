#pragma once
#include <string>

namespace strata {

// What is written over the picture; between Window::beginFrame() and finishFrame().

/// What the program tells the user. A newer message replaces an older one.
struct Messages {
  std::string notice;  ///< what was done last
  std::string error;   ///< stays until the user closes it
};

/// All keys and what the mouse does, in a window of its own while `open`, which turns false when the user closes it.
void drawHelp(bool& open);

/// Shows `text` until the user closes it, which empties it. Draws nothing where it is empty.
void drawError(std::string& text);

/// What the user is to do next, at the upper edge of the picture. Draws nothing where the text is empty.
void drawHint(const std::string& text);

/// The speed of a flight, metres per second, at the lower edge of the picture.
void drawFlySpeed(double speed);

/// An arc that turns in the corner of the picture.
void drawSpinner();

}  // namespace strata
