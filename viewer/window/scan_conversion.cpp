#include "viewer/window/scan_conversion.h"

#include <fcntl.h>
#include <imgui.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "viewer/bench/html_text.h"
#include "viewer/converter_program.h"
#include "viewer/window/window.h"

namespace strata {
namespace {

namespace fs = std::filesystem;

constexpr double kPoll = 0.1;  // seconds

enum class Answer { open, convert, leave };

/// One frame of the window that asks and shows. `said` is empty before the conversion has begun.
Answer drawQuestion(Window& window, const std::string& scan, const std::string& store, const std::string& said,
                    double seconds) {
  Answer answer = Answer::open;
  const WindowInput input = window.beginFrame(kPoll);
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::GetBackgroundDrawList()->AddRectFilled(ImVec2(0.0f, 0.0f), size, IM_COL32(24, 26, 30, 255));
  ImGui::SetNextWindowPos(ImVec2(0.5f * size.x, 0.5f * size.y), ImGuiCond_Always, ImVec2(0.5f, 0.5f));
  ImGui::SetNextWindowSizeConstraints(ImVec2(420.0f, 0.0f), ImVec2(0.9f * size.x, size.y));
  if (ImGui::Begin("Strata", nullptr, ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoCollapse)) {
    ImGui::Text("%s is a scan.", fs::path(scan).filename().string().c_str());
    if (seconds < 0.0) {
      ImGui::TextUnformatted("To fly through it, it is converted once to a store:");
      ImGui::TextDisabled("%s", store.c_str());
      if (ImGui::Button("convert") || input.keep) answer = Answer::convert;
      ImGui::SameLine();
      if (ImGui::Button("quit")) answer = Answer::leave;
    } else {
      ImGui::Text("Converting for %.0f s. %s", seconds, said.c_str());
      if (ImGui::Button("stop")) answer = Answer::leave;
    }
  }
  ImGui::End();
  window.finishFrame();
  window.present();
  return window.closed() ? Answer::leave : answer;
}

/// False when the user would rather not.
bool convertOne(const ViewerOptions& options, const std::string& scan, const std::string& store) {
  Window window("Strata", options.size.width, options.size.height, options.screenshot.empty());
  if (!options.convert) {
    Answer answer = Answer::open;
    while (answer == Answer::open) answer = drawQuestion(window, scan, store, "", -1.0);
    if (answer == Answer::leave) return false;
  }
  ScanConversion conversion(scan, store);
  const auto begin = std::chrono::steady_clock::now();
  for (;;) {
    const ScanConversion::State state = conversion.poll();
    if (state == ScanConversion::State::done) return true;
    if (state == ScanConversion::State::failed) throw Error(scan, "not converted: " + conversion.said());
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    if (drawQuestion(window, scan, store, conversion.said(), seconds) == Answer::leave) return false;
  }
}

}  // namespace

ScanConversion::ScanConversion(const std::string& scan, const std::string& store) {
  const std::string converter = converterProgram();
  std::vector<const char*> arguments{"strata-convert", scan.c_str(), "-o",   store.c_str(),
                                     "--resume",       "--json",     nullptr};
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
  if (!line.empty()) said_ = progressText(line);
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
    if (!isStore(store) && !convertOne(options, path, store)) return false;
    path = store;
  }
  return true;
}

}  // namespace strata
