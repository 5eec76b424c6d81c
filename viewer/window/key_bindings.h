#pragma once
#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "viewer/camera/camera_control.h"
#include "viewer/window/input_queue.h"

namespace strata {

/// What a key tells the viewer to do, once, in the frame in which the key goes down. keyBindings() says which key.
enum class Command : std::uint8_t {
  nextMoveMode,
  showAll,
  viewFront,
  viewSide,
  viewTop,
  togglePerspective,
  measureDistance,
  measureProfile,
  addClipBox,
  finish,
  takeBack,
  cancel,
  toggleOutputPanel,
  takePicture,
  addPathKey,
  toggleRecording,
  togglePlaying,
  saveProject,
  quit,
  toggleHelp,
  count  ///< not a command
};

/// The commands of one frame.
class CommandSet {
 public:
  bool has(Command command) const { return bits_[static_cast<std::size_t>(command)]; }
  void add(Command command) { bits_.set(static_cast<std::size_t>(command)); }
  bool none() const { return bits_.none(); }

 private:
  std::bitset<static_cast<std::size_t>(Command::count)> bits_;
};

/// One command and its key. The key does something else, or nothing, where Control is not held as `control` says.
struct KeyBinding {
  Command command;
  bool control;
  std::array<int, 2> keys;  ///< GLFW's codes; each of the two will do, and 0 is none
  const char* keyName;      ///< as the help writes it: "Control + S"
  const char* explanation;  ///< as the help writes it
};

/// Every command once, in the order of the help. A new key is one more row here and one more Command.
std::span<const KeyBinding> keyBindings();

/// The keyboard as of one frame.
class KeyboardState {
 public:
  void beginFrame() { pressed_.clear(); }
  /// Takes in an event of the kind InputEvent::Kind::key.
  void take(const InputEvent& event);

  /// The commands whose keys went down in this frame.
  CommandSet commands() const;
  /// The direction in which the keys held down fly. A key that went down with Control does not fly, not even while it
  /// is held longer than Control.
  FlyInput flying(bool fast) const;

 private:
  struct Press {
    int key = 0;
    bool control = false;

    bool operator==(const Press&) const = default;
  };
  static constexpr std::size_t kKeyCodes = 512;  ///< more than GLFW has

  std::vector<Press> pressed_;
  std::bitset<kKeyCodes> held_;  ///< the keys that are down and went down without Control
};

}  // namespace strata
