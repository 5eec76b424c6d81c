#include "viewer/window/key_bindings.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>

namespace strata {
namespace {

constexpr KeyBinding kBindings[] = {
    {Command::nextMoveMode, false, {GLFW_KEY_G}, "G", "the next way of moving: orbit, fly, earth"},
    {Command::showAll, false, {GLFW_KEY_F}, "F", "show everything"},
    {Command::viewFront, false, {GLFW_KEY_1, GLFW_KEY_KP_1}, "1", "from the front"},
    {Command::viewSide, false, {GLFW_KEY_3, GLFW_KEY_KP_3}, "3", "from the side"},
    {Command::viewTop, false, {GLFW_KEY_7, GLFW_KEY_KP_7}, "7", "from the top"},
    {Command::togglePerspective, false, {GLFW_KEY_O}, "O", "with perspective, without"},
    {Command::measureDistance, false, {GLFW_KEY_M}, "M", "measure a distance"},
    {Command::measureProfile, false, {GLFW_KEY_X}, "X", "measure a cross-section"},
    {Command::finish, false, {GLFW_KEY_ENTER, GLFW_KEY_KP_ENTER}, "Enter", "keep the measurement"},
    {Command::takeBack, false, {GLFW_KEY_BACKSPACE}, "Backspace", "take back its last point"},
    {Command::cancel, false, {GLFW_KEY_ESCAPE}, "Escape", "drop it; give up a picture or a film"},
    {Command::addClipBox, false, {GLFW_KEY_B}, "B", "new clip box; drag its dots"},
    {Command::toggleOutputPanel, false, {GLFW_KEY_P}, "P", "pictures of any size, camera paths, films"},
    {Command::takePicture, true, {GLFW_KEY_P}, "Control + P", "take the picture at once"},
    {Command::addPathKey, false, {GLFW_KEY_K}, "K", "camera path: set a key"},
    {Command::toggleRecording, false, {GLFW_KEY_R}, "R", "camera path: record, stop"},
    {Command::togglePlaying, false, {GLFW_KEY_SPACE}, "space", "camera path: play, stop"},
    {Command::saveProject, true, {GLFW_KEY_S}, "Control + S", "save the project and the camera path"},
    {Command::quit, true, {GLFW_KEY_Q}, "Control + Q", "quit"},
    {Command::toggleHelp, false, {GLFW_KEY_H, GLFW_KEY_F1}, "H, F1", "this help"},
};

}  // namespace

std::span<const KeyBinding> keyBindings() { return kBindings; }

void KeyboardState::take(const InputEvent& event) {
  if (event.repeated) return;
  const bool control = (event.modifiers & GLFW_MOD_CONTROL) != 0;
  if (event.down) pressed_.push_back({event.code, control});
  // GLFW gives a key that it does not know the code -1.
  if (event.code >= 0) held_.set(static_cast<std::size_t>(event.code), event.down && !control);
}

CommandSet KeyboardState::commands() const {
  static_assert(GLFW_KEY_LAST < kKeyCodes);
  CommandSet commands;
  for (const KeyBinding& binding : kBindings)
    for (const int key : binding.keys)
      if (std::find(pressed_.begin(), pressed_.end(), Press{key, binding.control}) != pressed_.end())
        commands.add(binding.command);
  return commands;
}

FlyInput KeyboardState::flying(bool fast) const {
  const auto held = [this](std::size_t key) { return held_[key] ? 1 : 0; };
  return {.forward = held(GLFW_KEY_W) - held(GLFW_KEY_S),
          .right = held(GLFW_KEY_D) - held(GLFW_KEY_A),
          .up = held(GLFW_KEY_E) - held(GLFW_KEY_Q),
          .fast = fast};
}

}  // namespace strata
