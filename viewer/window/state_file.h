#pragma once
#include <cstdint>
#include <string>

#include <glm/glm.hpp>

#include "viewer/window/window.h"

namespace strata {

/// What strata-view does and holds in one frame, for a script that uses it by hand.
struct ShownState {
  bool settled = false;  ///< nothing comes of what was done so far that is not on the screen
  bool hidden = false;
  glm::ivec2 size{0};  ///< of the framebuffer
  glm::dvec3 eye{0.0};
  std::string moving{};      ///< "orbit", "fly", "earth"
  int measuring = -1;        ///< points of the measurement that is being made; -1: none
  std::size_t measured = 0;  ///< measurements that are kept
  std::size_t clipBoxes = 0;
  std::size_t hiddenClasses = 0;
  std::size_t pathKeys = 0;
  bool recording = false, playing = false;
  bool working = false;     ///< on a picture or a film
  std::uint64_t drawn = 0;  ///< frames in which the scene was drawn
  std::string picked{};     ///< coordinates of the last point
  std::string notice{}, error{};
};

/// The file that `--state` names: one JSON object, replaced after every frame.
class StateFile {
 public:
  explicit StateFile(std::string path) : path_(std::move(path)) {}

  /// With what the window has taken in, and where the items of its panels stand. Nothing where no file is named. Throws
  /// Error where it cannot be written.
  void write(const Window& window, const ShownState& state);

 private:
  const std::string path_;  ///< empty: none
  std::uint64_t frame_ = 0;
};

}  // namespace strata
