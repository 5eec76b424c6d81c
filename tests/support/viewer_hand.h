#pragma once
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <map>
#include <optional>
#include <sstream>
#include <thread>

#include "tests/support/programs.h"

namespace strata::test {

/// A program that runs beside the test and is killed with this object.
class RunningProgram {
 public:
  /// Starts the program in `folder`. Its stderr goes to the file `saidTo` there. It inherits the file descriptor
  /// `keptOpen` and no other.
  RunningProgram(const std::string& program, const std::vector<std::string>& arguments,
                 const std::map<std::string, std::string>& environment, const std::filesystem::path& folder,
                 const std::string& saidTo, int keptOpen = -1)
      : saidTo_(folder / saidTo) {
    std::vector<char*> argv{const_cast<char*>(program.c_str())};
    for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    process_ = fork();
    if (process_ < 0) throw std::runtime_error("cannot fork");
    if (process_ > 0) return;
    for (const auto& [name, value] : environment) setenv(name.c_str(), value.c_str(), 1);
    if (chdir(folder.c_str()) != 0) _exit(126);
    dup2(open("/dev/null", O_RDWR), STDIN_FILENO);
    dup2(STDIN_FILENO, STDOUT_FILENO);
    dup2(open(saidTo.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDERR_FILENO);
    for (int file = 3; file < 64; ++file)
      if (file != keptOpen) close(file);
    execv(program.c_str(), argv.data());
    _exit(127);
  }
  ~RunningProgram() {
    if (process_ <= 0) return;
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
  }
  RunningProgram(const RunningProgram&) = delete;
  RunningProgram& operator=(const RunningProgram&) = delete;

  /// Its exit code, once it has ended.
  std::optional<int> ended() {
    int status = 0;
    if (process_ > 0 && waitpid(process_, &status, WNOHANG) == process_) {
      process_ = -1;
      code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    }
    return process_ > 0 ? std::nullopt : std::optional(code_);
  }
  pid_t process() const { return process_; }
  /// Everything on its stderr so far.
  std::string said() const { return readWhole(saidTo_); }

 private:
  std::filesystem::path saidTo_;
  pid_t process_ = -1;
  int code_ = -1;
};

struct HandOptions {
  std::map<std::string, std::string> environment;
  std::string screen = "1024x768x24";
  std::string dpi = "96";
};

/// Uses strata-view by mouse and keys, in an X server of its own. Every call waits until the viewer has taken in the
/// events that the call made, which the viewer reports after every frame (`--state`).
class ViewerHand {
 public:
  static constexpr const char* kXvfb = "/usr/bin/Xvfb";
  static constexpr const char* kXdotool = "/usr/bin/xdotool";
  static bool possible() { return std::filesystem::exists(kXvfb) && std::filesystem::exists(kXdotool); }

  /// Starts the server and the viewer, in `folder`. Throws where one of them does not start.
  ViewerHand(const std::filesystem::path& folder, std::vector<std::string> arguments, HandOptions options = {})
      : folder_(folder) {
    int ends[2];
    if (pipe(ends) != 0) throw std::runtime_error("no pipe");
    server_.emplace(kXvfb,
                    std::vector<std::string>{"-displayfd", std::to_string(ends[1]), "-screen", "0", options.screen,
                                             "-dpi", options.dpi, "-noreset", "-nolisten", "tcp"},
                    std::map<std::string, std::string>{}, folder, "x.err", ends[1]);
    close(ends[1]);
    char c = 0;
    while (read(ends[0], &c, 1) == 1 && c != '\n') display_ += c;
    close(ends[0]);
    if (display_ == ":") throw std::runtime_error("Xvfb does not start: " + server_->said());
    options.environment["DISPLAY"] = display_;
    arguments.insert(arguments.end(), {"--state", stateFile().string()});
    std::filesystem::remove(stateFile());
    viewer_.emplace(programPath("strata-view").string(), arguments, options.environment, folder, "viewer.err");
    settled();
    takeFocus();
  }

  const std::filesystem::path& folder() const { return folder_; }
  /// The newest state that the window has reported.
  Json state() const { return newest_; }
  std::string said() const { return viewer_->said(); }
  const std::string& display() const { return display_; }

  /// Waits until the state fulfils `wanted`, and returns it. Throws where it does not within kPatience; `what` is for
  /// the message.
  Json until(const std::string& what, const std::function<bool(const Json&)>& wanted) {
    const auto giveUp = std::chrono::steady_clock::now() + std::chrono::seconds(kPatience);
    while (!readState() || !wanted(newest_)) {
      if (viewer_->ended()) throw std::runtime_error("the viewer has ended, waiting for " + what + ": " + said());
      if (std::chrono::steady_clock::now() > giveUp)
        throw std::runtime_error("waited for " + what + " in vain; " + newest_.dump());
      pause();
    }
    return newest_;
  }
  Json settled() {
    return until("it to settle", [](const Json& s) { return s["settled"].get<bool>(); });
  }
  Json until(const std::string& field, const Json& value) {
    return until(field + " = " + value.dump(), [&](const Json& s) { return s.at(field) == value; });
  }
  /// Waits for `count` more frames.
  Json frames(int count) {
    const auto wanted = newest_["frame"].get<std::int64_t>() + count;
    return until("more frames", [wanted](const Json& s) { return s["frame"].get<std::int64_t>() >= wanted; });
  }

  /// Presses a key, by xdotool's name for it: "m", "ctrl+s", "Return".
  void key(const std::string& name) {
    const auto keys = 1 + std::count(name.begin(), name.end(), '+');
    counted("keys", 2 * static_cast<int>(keys), {"key", name});
  }
  void keyDown(const std::string& name) { counted("keys", 1, {"keydown", name}); }
  void keyUp(const std::string& name) { counted("keys", 1, {"keyup", name}); }
  void write(const std::string& letters) {
    for (const char letter : letters) key(std::string(1, letter));
  }
  void moveTo(int x, int y) {
    xdotool({"mousemove", std::to_string(x), std::to_string(y)});
    until("the cursor", [&](const Json& s) { return s["cursor"] == Json{x, y}; });
  }
  void press(int button = 1) { counted("buttons", 1, {"mousedown", std::to_string(button)}); }
  void release(int button = 1) { counted("buttons", 1, {"mouseup", std::to_string(button)}); }
  void click(int x, int y) {
    moveTo(x, y);
    counted("buttons", 2, {"click", "1"});
  }
  /// Clicks at all places without a pause between them.
  void clicksAtOnce(const std::vector<std::pair<int, int>>& places) {
    std::vector<std::string> all;
    for (const auto& [x, y] : places)
      all.insert(all.end(), {"mousemove", std::to_string(x), std::to_string(y), "click", "1"});
    counted("buttons", 2 * static_cast<int>(places.size()), all);
  }
  void doubleClick(int x, int y) {
    moveTo(x, y);
    counted("buttons", 4, {"click", "--repeat", "2", "--delay", "20", "1"});
  }
  void drag(int x0, int y0, int x1, int y1, int button = 1) {
    moveTo(x0, y0);
    press(button);
    for (int i = 1; i <= 4; ++i) moveTo(x0 + (x1 - x0) * i / 4, y0 + (y1 - y0) * i / 4);
    release(button);
  }
  void wheel(int notches) {
    counted("wheel", std::abs(notches),
            {"click", "--repeat", std::to_string(std::abs(notches)), "--delay", "5", notches > 0 ? "4" : "5"});
  }
  /// Clicks an item of a panel, by the name that the state has for it.
  void clickItem(const std::string& name) {
    const Json place =
        until("the item " + name, [&](const Json& s) { return s["items"].contains(name); })["items"][name];
    click(static_cast<int>(place[0].get<double>()), static_cast<int>(place[1].get<double>()));
  }
  void resize(int width, int height) {
    xdotool({"windowsize", window_, std::to_string(width), std::to_string(height)});
    until("size", Json{width, height});
  }
  void hide() {
    xdotool({"windowunmap", window_});
    until("hidden", Json(true));
  }
  void show() {
    xdotool({"windowmap", window_});
    until("hidden", Json(false));
    takeFocus();
  }
  /// Presses Control + S and returns what that wrote to `file` in the folder.
  Json save(const std::string& file) {
    key("ctrl+s");
    return Json::parse(readWhole(folder_ / file));
  }
  /// Turns from the window that asked whether to convert a scan to the one that follows it.
  void turnToScene() {
    until("the scene", [](const Json& s) { return s["drawn"].get<int>() > 0 && s["settled"].get<bool>(); });
    takeFocus();
  }
  /// Writes a picture of the whole screen to a PNG file in the folder.
  void photograph(const std::string& name) {
    const Finished made =
        runProgram("/usr/bin/ffmpeg", {"-loglevel", "error", "-y", "-f", "x11grab", "-draw_mouse", "0", "-i", display_,
                                       "-frames:v", "1", (folder_ / name).string()});
    if (made.exitCode != 0) throw std::runtime_error("no picture: " + made.err);
  }
  /// Presses Control + Q and returns the exit code.
  int quit() {
    xdotool({"key", "ctrl+q"});
    const auto giveUp = std::chrono::steady_clock::now() + std::chrono::seconds(kPatience);
    for (;; pause()) {
      if (const auto code = viewer_->ended()) return *code;
      if (std::chrono::steady_clock::now() > giveUp) throw std::runtime_error("the viewer does not quit");
    }
  }
  /// The CPU time of all threads of the viewer, in hundredths of a second.
  long cpuTicks() const {
    std::string text = readWhole("/proc/" + std::to_string(viewer_->process()) + "/stat");
    std::istringstream fields(text.substr(text.rfind(')') + 2));
    std::string field;
    long ticks = 0;
    for (int i = 3; i <= 15 && fields >> field; ++i)
      if (i >= 14) ticks += std::stol(field);
    return ticks;
  }

 private:
  static constexpr int kPatience = 120;  // seconds, on a busy machine

  static void pause() { std::this_thread::sleep_for(std::chrono::milliseconds(20)); }
  std::filesystem::path stateFile() const { return folder_ / "state.json"; }
  bool readState() {
    const Json read = Json::parse(readWhole(stateFile()), nullptr, false);
    if (!read.is_object()) return false;
    newest_ = read;
    return true;
  }
  std::string xdotool(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"DISPLAY=" + display_, "timeout", "60", kXdotool});
    const Finished finished = runProgram("/usr/bin/env", arguments);
    if (finished.exitCode != 0) throw std::runtime_error("xdotool fails: " + arguments[4] + " " + finished.err);
    return finished.out;
  }
  /// Calls xdotool, and waits until the viewer's count `counter` of events has grown by `events`.
  void counted(const char* counter, int events, const std::vector<std::string>& what) {
    const auto wanted = until("its state", [](const Json&) { return true; })[counter].get<int>() + events;
    xdotool(what);
    until(what[0] + " " + what.back(), [&](const Json& s) { return s[counter].get<int>() >= wanted; });
  }
  void takeFocus() {
    window_ = linesOf(xdotool({"search", "--sync", "--onlyvisible", "--name", "Strata"})).at(0);
    // A window that has just been mapped cannot take the focus yet, so this is tried again and again.
    until("the focus", [this](const Json& s) {
      if (s["focused"].get<bool>()) return true;
      runProgram("/usr/bin/env", {"DISPLAY=" + display_, "timeout", "60", kXdotool, "windowfocus", window_});
      return false;
    });
  }

  std::filesystem::path folder_;
  std::optional<RunningProgram> server_, viewer_;
  std::string display_ = ":", window_;
  Json newest_;
};

}  // namespace strata::test
