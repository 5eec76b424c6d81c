#pragma once
#include <cstdint>
#include <string>

#include <glm/glm.hpp>

#include "viewer/window/window.h"

namespace strata {

/// What strata-view shows and does in one frame, for scripts that move its mouse and press its keys.
struct ShownState {
  bool settled = false;  ///< everything that the user did so far has had its effect on the screen
  bool hidden = false;
  glm::ivec2 size{0};  ///< of the framebuffer
  glm::dvec3 eye{0.0};
  std::string moving{};      ///< "orbit", "fly", "earth"
  int measuring = -1;        ///< points of the measurement that is being made; -1: there is none
  std::size_t measured = 0;  ///< measurements that are kept
  std::size_t clipBoxes = 0;
  std::size_t hiddenClasses = 0;
  std::size_t pathKeys = 0;
  bool recording = false, playing = false;
  bool working = false;     ///< a picture or a film is being drawn into a file
  std::uint64_t drawn = 0;  ///< frames in which the layers were drawn
  std::string picked{};     ///< coordinates of the point clicked last
  std::string notice{}, error{};
};

/// The file that `--state` names: one JSON object, replaced after every frame.
class StateFile {
 public:
  explicit StateFile(std::string path) : path_(std::move(path)) {}

  /// Writes `state`, the events that the window has taken in and the positions of the items in its panels. Does nothing
  /// where there is no file. Throws Error where the file cannot be written.
  void write(const Window& window, const ShownState& state);

 private:
  const std::string path_;  ///< empty: there is no file
  std::uint64_t frame_ = 0;
};

}  // namespace strata
