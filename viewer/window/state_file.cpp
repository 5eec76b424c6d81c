#include "viewer/window/state_file.h"

#include <nlohmann/json.hpp>

#include "io/file/text_file.h"

namespace strata {

void StateFile::write(const Window& window, const ShownState& state) {
  if (path_.empty()) return;
  const InputCounts& counts = window.inputCounts();
  nlohmann::json json{{"frame", ++frame_},
                      {"focused", window.focused()},
                      {"keys", counts.keys},
                      {"buttons", counts.buttons},
                      {"wheel", counts.wheel},
                      {"cursor", {window.cursor().x, window.cursor().y}},
                      {"settled", state.settled},
                      {"hidden", state.hidden},
                      {"size", {state.size.x, state.size.y}},
                      {"eye", {state.eye.x, state.eye.y, state.eye.z}},
                      {"moving", state.moving},
                      {"measuring", state.measuring},
                      {"measured", state.measured},
                      {"clip_boxes", state.clipBoxes},
                      {"hidden_classes", state.hiddenClasses},
                      {"path_keys", state.pathKeys},
                      {"recording", state.recording},
                      {"playing", state.playing},
                      {"drawn", state.drawn},
                      {"working", state.working},
                      {"picked", state.picked},
                      {"notice", state.notice},
                      {"error", state.error},
                      {"items", nlohmann::json::object()}};
  for (const auto& [name, place] : window.itemPositions()) json["items"][name] = {place.x, place.y};
  writeText(path_, json.dump() + "\n");
}

}  // namespace strata
