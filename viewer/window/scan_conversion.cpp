#include "viewer/window/scan_conversion.h"

#include <fcntl.h>
#include <imgui.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/readable.h"
#include "viewer/session/converter_program.h"
#include "viewer/window/item_positions.h"
#include "viewer/window/overlay.h"
#include "viewer/window/state_file.h"
#include "viewer/window/window.h"

namespace strata {
namespace {

namespace fs = std::filesystem;

constexpr double kPoll = 0.1;          // seconds
constexpr float kFieldWidth = 420.0f;  // pixels, on an ordinary screen

enum class Answer { open, convert, leave };

/// The window that asks whether to convert a scan, and shows how far that is.
class Question {
 public:
  Question(const ViewerOptions& options, const std::string& scan, const std::string& store)
      : window_("Strata", options.size.width, options.size.height, options.screenshot.empty()),
        stateFile_(options.state),
        scan_(fs::path(scan).filename().string()),
        store_(store) {}

  /// One frame before the conversion. `failure` says why the last one did not work; empty where there was none.
  Answer ask(const std::string& failure) {
    return draw(
        [&](const WindowInput& input) {
          ImGui::Text("%s is a scan.", scan_.c_str());
          ImGui::TextUnformatted("To fly through it, it is converted once to a store:");
          char text[4096];
          std::snprintf(text, sizeof text, "%s", store_.c_str());
          ImGui::SetNextItemWidth(kFieldWidth * uiScale());
          if (ImGui::InputText("##store", text, sizeof text)) store_ = text;
          noteItem("store");
          if (!failure.empty()) {
            ImGui::PushTextWrapPos(kFieldWidth * uiScale());
            ImGui::TextColored(ImVec4(1.0f, 0.6f, 0.45f, 1.0f), "%s", failure.c_str());
            ImGui::PopTextWrapPos();
          }
          ImGui::Spacing();
          Answer answer = input.keep ? Answer::convert : Answer::open;
          if (button("convert")) answer = Answer::convert;
          ImGui::SameLine();
          if (button("quit")) answer = Answer::leave;
          return answer;
        },
        failure);
  }

  /// One frame of the progress; `leave` stops it.
  Answer show(const ScanConversion& conversion, double seconds) {
    return draw(
        [&](const WindowInput& input) {
          ImGui::Text("Converting %s", scan_.c_str());
          ImGui::Spacing();
          ImGui::ProgressBar(static_cast<float>(conversion.share()), ImVec2(kFieldWidth * uiScale(), 0.0f));
          ImGui::TextUnformatted(conversion.said().empty() ? " " : conversion.said().c_str());
          ImGui::TextDisabled("for %.0f s", seconds);
          ImGui::Spacing();
          return button("stop") || input.drop ? Answer::leave : Answer::open;
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
    Answer answer = Answer::open;
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

/// The store, when there is one; empty when the user would rather not. Throws Error where nobody can be asked.
std::string convertOne(const ViewerOptions& options, const std::string& scan) {
  Question question(options, scan, storeBeside(scan));
  for (std::string failure;;) {
    for (Answer answer = Answer::open; !options.convert && answer != Answer::convert;) {
      answer = question.ask(failure);
      if (answer == Answer::leave) return {};
    }
    failure.clear();
    const std::string store = question.store();
    ScanConversion conversion(scan, store);
    const auto begin = std::chrono::steady_clock::now();
    for (ScanConversion::State state; failure.empty();) {
      state = conversion.poll();
      if (state == ScanConversion::State::done) return store;
      const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
      if (state == ScanConversion::State::failed)
        failure = conversion.said();
      else if (question.show(conversion, seconds) == Answer::leave)
        failure = "Stopped. Converting again goes on from here.";
      if (!failure.empty() && (question.closed() || options.convert)) {
        if (state == ScanConversion::State::failed) throw Error(scan, "not converted: " + failure);
        return {};
      }
    }
  }
}

}  // namespace

ScanConversion::ScanConversion(const std::string& scan, const std::string& store) {
  const std::string converter = converterProgram();
  std::vector<const char*> arguments{"strata-convert", scan.c_str(),       "-o",  store.c_str(), "--resume",
                                     "--json",         "--progress-every", "0.5", nullptr};
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC | O_NONBLOCK) != 0) throw posixError(converter, "starting", errno);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  const int failure =
      ::posix_spawn(&process_, converter.c_str(), &actions, nullptr, const_cast<char**>(arguments.data()), environ);
  posix_spawn_file_actions_destroy(&actions);
  ::close(ends[1]);
  pipe_ = ends[0];
  if (failure == 0) return;
  ::close(pipe_);
  throw posixError(converter, "starting", failure);
}

ScanConversion::~ScanConversion() {
  if (process_ > 0) {
    ::kill(process_, SIGINT);
    ::waitpid(process_, nullptr, 0);
  }
  ::close(pipe_);
}

void ScanConversion::takeLine(const std::string& line) {
  if (line.empty()) return;
  said_ = progressText(line.starts_with("error: ") ? line.substr(7) : line);
  share_ = progressShare(line).value_or(share_);
}

ScanConversion::State ScanConversion::poll() {
  char buffer[4096];
  int status = 0;
  // Whether it has ended is asked before reading, so that its last words are in the pipe by then.
  const bool ended = process_ > 0 && ::waitpid(process_, &status, WNOHANG) == process_;
  for (ssize_t got; (got = ::read(pipe_, buffer, sizeof buffer)) > 0;)
    text_.append(buffer, static_cast<std::size_t>(got));
  for (std::size_t end; (end = text_.find('\n')) != std::string::npos; text_.erase(0, end + 1))
    takeLine(text_.substr(0, end));
  if (!ended) return State::running;
  process_ = -1;
  return WIFEXITED(status) && WEXITSTATUS(status) == 0 ? State::done : State::failed;
}

std::optional<double> progressShare(const std::string& line) {
  const nlohmann::json json = nlohmann::json::parse(line, nullptr, false);
  if (!json.is_object() || !json.contains("points_total") || !json.contains("points_done")) return std::nullopt;
  const double total = json.value("points_total", 0.0);
  return total > 0.0 ? std::optional(std::clamp(json.value("points_done", 0.0) / total, 0.0, 1.0)) : std::nullopt;
}

std::string progressText(const std::string& line) {
  const nlohmann::json json = nlohmann::json::parse(line, nullptr, false);
  if (!json.is_object() || !json.contains("progress")) return line;
  const auto number = [&](const char* name) {
    return json.contains(name) && json[name].is_number() ? json[name].get<double>() : 0.0;
  };
  std::string text = json["progress"].is_string() ? json["progress"].get<std::string>() : std::string();
  if (const double total = number("points_total"); total > 0.0)
    text += ", " + std::to_string(std::lround(100.0 * number("points_done") / total)) + " %";
  if (const double rate = number("points_per_second"); rate > 0.0) text += ", " + readableCount(rate) + " points/s";
  if (const double left = number("seconds_left"); left > 0.0)
    text += ", " + std::to_string(std::lround(left)) + " s left";
  return text;
}

std::string storeBeside(const std::string& scan) {
  fs::path path = fs::path(scan).lexically_normal();
  if (!path.has_filename()) path = path.parent_path();  // a folder with a slash behind its name
  return path.replace_extension(".strata").string();
}

bool isStore(const std::string& path) { return fs::exists(fs::path(path) / "store.json"); }

bool convertScans(ViewerOptions& options) {
  for (std::string& path : options.stores) {
    const bool synthetic = path.starts_with("synthetic:");
    if (synthetic || isStore(path) || !fs::exists(path)) continue;  // opening the latter says what is wrong
    const std::string store = storeBeside(path);
    if (store == path) continue;
    path = isStore(store) ? store : convertOne(options, path);
    if (path.empty()) return false;
  }
  return true;
}

}  // namespace strata
