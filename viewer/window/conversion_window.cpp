#include "viewer/window/conversion_window.h"

#include <imgui.h>

#include <chrono>
#include <filesystem>
#include <string>

#include "core/error.h"
#include "viewer/window/item_positions.h"
#include "viewer/window/overlay.h"
#include "viewer/window/scan_conversion.h"
#include "viewer/window/state_file.h"
#include "viewer/window/widgets.h"
#include "viewer/window/window.h"

namespace strata {
namespace {

namespace fs = std::filesystem;

constexpr double kPoll = 0.1;          // seconds between two frames of the progress
constexpr float kFieldWidth = 420.0f;  // pixels, on an ordinary screen

enum class Answer { none, convert, leave };

/// The window that asks whether to convert a scan and then shows the progress.
class ConversionWindow {
 public:
  ConversionWindow(const ViewerOptions& options, const std::string& scan, const std::string& store)
      : window_("Strata", options.size.width, options.size.height, options.screenshot.empty()),
        stateFile_(options.state),
        scan_(fs::path(scan).filename().string()),
        store_(store) {}

  /// One frame before the conversion. `failure` says why the last conversion failed; empty where there was none.
  Answer ask(const std::string& failure) {
    return draw(
        [&](const WindowInput& input) {
          ImGui::Text("%s is a scan.", scan_.c_str());
          ImGui::TextUnformatted("To fly through it, it is converted once to a store:");
          ImGui::SetNextItemWidth(kFieldWidth * uiScale());
          inputText("##store", store_);
          noteItem("store");
          if (!failure.empty()) {
            ImGui::PushTextWrapPos(kFieldWidth * uiScale());
            ImGui::TextColored(ImVec4(1.0f, 0.6f, 0.45f, 1.0f), "%s", failure.c_str());
            ImGui::PopTextWrapPos();
          }
          ImGui::Spacing();
          Answer answer = input.has(Command::finish) ? Answer::convert : Answer::none;
          if (button("convert")) answer = Answer::convert;
          ImGui::SameLine();
          if (button("quit")) answer = Answer::leave;
          return answer;
        },
        failure);
  }

  /// One frame of the progress. The answer `leave` stops the conversion.
  Answer show(const ScanConversion& conversion, double seconds) {
    return draw(
        [&](const WindowInput& input) {
          ImGui::Text("Converting %s", scan_.c_str());
          ImGui::Spacing();
          ImGui::ProgressBar(static_cast<float>(conversion.share()), ImVec2(kFieldWidth * uiScale(), 0.0f));
          ImGui::TextUnformatted(conversion.said().empty() ? " " : conversion.said().c_str());
          ImGui::TextDisabled("for %.0f s", seconds);
          ImGui::Spacing();
          return button("stop") || input.has(Command::cancel) ? Answer::leave : Answer::none;
        },
        "");
  }

  const std::string& store() const { return store_; }
  bool closed() const { return window_.closed(); }

 private:
  static bool button(const char* name) {
    const bool pressed = ImGui::Button(name);
    noteItem(name);
    return pressed;
  }

  template <class Inside>
  Answer draw(Inside inside, const std::string& failure) {
    const WindowInput input = window_.beginFrame(kPoll);
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    ImGui::GetBackgroundDrawList()->AddRectFilled(ImVec2(0.0f, 0.0f), size, IM_COL32(24, 26, 30, 255));
    ImGui::SetNextWindowPos(ImVec2(0.5f * size.x, 0.5f * size.y), ImGuiCond_Always, ImVec2(0.5f, 0.5f));
    Answer answer = Answer::none;
    if (ImGui::Begin("Strata", nullptr, ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoCollapse))
      answer = inside(input);
    ImGui::End();
    window_.finishFrame();
    window_.present();
    stateFile_.write(window_, {.settled = input.idle(), .size = {input.width, input.height}, .error = failure});
    return window_.closed() ? Answer::leave : answer;
  }

  Window window_;
  StateFile stateFile_;
  const std::string scan_;
  std::string store_;
};

/// The path of the store that belongs to a scan: beside it, with the ending .strata.
std::string storeBeside(const std::string& scan) {
  fs::path path = fs::path(scan).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();  // a folder with a slash behind its name
  return path.replace_extension(".strata").string();
}

bool isStore(const std::string& path) { return fs::exists(fs::path(path) / "store.json"); }

/// Converts one scan and gives the path of its store; empty when the user does not want to. With options.convert a
/// failure throws Error.
std::string convertOne(const ViewerOptions& options, const std::string& scan) {
  ConversionWindow window(options, scan, storeBeside(scan));
  for (std::string failure;;) {
    for (Answer answer = Answer::none; !options.convert && answer != Answer::convert;) {
      answer = window.ask(failure);
      if (answer == Answer::leave) return {};
    }
    failure.clear();
    const std::string store = window.store();
    ScanConversion conversion(scan, store);
    const auto begin = std::chrono::steady_clock::now();
    while (failure.empty()) {
      const ScanConversion::State state = conversion.poll();
      if (state == ScanConversion::State::done) return store;
      const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
      if (state == ScanConversion::State::failed)
        failure = conversion.said().empty() ? "strata-convert ended and gave no reason" : conversion.said();
      else if (window.show(conversion, seconds) == Answer::leave)
        failure = "Stopped. Converting again goes on from here.";
      if (!failure.empty() && (window.closed() || options.convert)) {
        if (state == ScanConversion::State::failed) throw Error(scan, "not converted: " + failure);
        return {};
      }
    }
  }
}

}  // namespace

bool convertScans(ViewerOptions& options) {
  for (std::string& path : options.stores) {
    const bool synthetic = path.starts_with("synthetic:");
    // A path that does not exist is left for openStores(), which says what is wrong.
    if (synthetic || isStore(path) || !fs::exists(path)) continue;
    const std::string store = storeBeside(path);
    if (store == path) continue;
    path = isStore(store) ? store : convertOne(options, path);
    if (path.empty()) return false;
  }
  return true;
}

}  // namespace strata
