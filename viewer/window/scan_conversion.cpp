#include "viewer/window/scan_conversion.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "core/error.h"
#include "core/readable.h"
#include "viewer/session/converter_program.h"

namespace strata {
namespace {

/// What a progress line of `strata-convert --json` says, for people; the line itself where it is something else.
std::string progressText(const nlohmann::json& json, const std::string& line) {
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

/// The share of the present stage that is done; nothing where the line does not say it.
std::optional<double> progressShare(const nlohmann::json& json) {
  if (!json.is_object() || !json.contains("points_total") || !json.contains("points_done")) return std::nullopt;
  const double total = json.value("points_total", 0.0);
  return total > 0.0 ? std::optional(std::clamp(json.value("points_done", 0.0) / total, 0.0, 1.0)) : std::nullopt;
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
  const nlohmann::json json = nlohmann::json::parse(line, nullptr, false);
  said_ = progressText(json, line.starts_with("error: ") ? line.substr(7) : line);
  share_ = progressShare(json).value_or(share_);
}

ScanConversion::State ScanConversion::poll() {
  char buffer[4096];
  int status = 0;
  // This is asked before reading: once the process has ended, everything that it said is in the pipe.
  const bool ended = process_ > 0 && ::waitpid(process_, &status, WNOHANG) == process_;
  for (ssize_t got; (got = ::read(pipe_, buffer, sizeof buffer)) > 0;)
    text_.append(buffer, static_cast<std::size_t>(got));
  for (std::size_t end; (end = text_.find('\n')) != std::string::npos; text_.erase(0, end + 1))
    takeLine(text_.substr(0, end));
  if (!ended) return State::running;
  process_ = -1;
  return WIFEXITED(status) && WEXITSTATUS(status) == 0 ? State::done : State::failed;
}

}  // namespace strata
