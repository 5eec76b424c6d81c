#include "converter/programs/progress_display.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string_view>

#include "converter/journal/disk_room.h"

namespace strata {
namespace {

constexpr std::chrono::milliseconds kTerminalInterval{250};
constexpr double kPatienceSeconds = 2.0;      // a stage may take longer than usual by so much
constexpr std::size_t kTerminalColumns = 80;  // where the terminal does not say

/// The cost of a stage on the machine of docs/benchmarks.md, for LAS. Reading LAZ takes more, but while it is read its
/// own rate counts.
struct StageCost {
  std::string_view stage;
  double micros;  ///< CPU microseconds per point
};
constexpr std::array<StageCost, 7> kTypicalMicros{{{stage::kSurvey, 0.0},
                                                   {stage::kMeasure, 0.10},
                                                   {stage::kDistribute, 0.10},
                                                   {stage::kBuild, 0.20},
                                                   {stage::kMerge, 0.03},
                                                   {stage::kNormals, 3.0},
                                                   {stage::kWrite, 0.01}}};

/// The index into kTypicalMicros; its size for an unknown stage.
std::size_t indexOf(std::string_view stage) {
  const auto at = std::find_if(kTypicalMicros.begin(), kTypicalMicros.end(),
                               [&](const StageCost& cost) { return cost.stage == stage; });
  return static_cast<std::size_t>(at - kTypicalMicros.begin());
}

/// The memory that the program has now; 0 where the system does not say.
std::uint64_t residentBytes() {
  std::ifstream in("/proc/self/statm");
  std::uint64_t size = 0, resident = 0;
  in >> size >> resident;
  return resident * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

std::size_t columnsOf(std::FILE* out) {
  winsize size{};
  return ::ioctl(::fileno(out), TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : kTerminalColumns;
}

std::string formatted(const char* format, double value) {
  char text[48];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

double shareOf(std::uint64_t done, std::uint64_t total) {
  return total > 0 ? std::min(1.0, static_cast<double>(done) / static_cast<double>(total)) : 0.0;
}

}  // namespace

std::optional<double> secondsLeft(const Progress& progress, double stageSeconds, std::uint64_t points, int threads) {
  const std::size_t running = indexOf(progress.stage);
  if (points == 0 || running == kTypicalMicros.size()) return std::nullopt;
  const double typical = 1e-6 * static_cast<double>(points) / std::max(1, threads);
  const double share = shareOf(progress.done, progress.total);
  double left =
      share > 0.0 ? stageSeconds * (1.0 - share) / share : kTypicalMicros[running].micros * typical - stageSeconds;
  if (left < -kPatienceSeconds) return std::nullopt;
  left = std::max(0.0, left);
  for (std::size_t next = running + 1; next < kTypicalMicros.size(); ++next)
    if (kTypicalMicros[next].stage != stage::kMeasure && kTypicalMicros[next].stage != stage::kNormals)
      left += kTypicalMicros[next].micros * typical;
  return left;
}

std::string durationText(double seconds) {
  const auto whole = static_cast<std::uint64_t>(std::max(0.0, std::ceil(seconds)));
  if (whole < 60) return std::to_string(whole) + " s";
  if (whole < 3600) return std::to_string(whole / 60) + " min " + std::to_string(whole % 60) + " s";
  return std::to_string(whole / 3600) + " h " + std::to_string(whole % 3600 / 60) + " min";
}

std::string progressLine(const ProgressMoment& moment) {
  std::string line = moment.stage;
  line.resize(std::max<std::size_t>(line.size(), 10), ' ');
  if (moment.total > 0)
    line += formatted(" %3.0f %%", std::floor(100.0 * shareOf(moment.done, moment.total))) +
            formatted("  %.1f", 1e-6 * static_cast<double>(moment.done)) +
            formatted("/%.1f M points", 1e-6 * static_cast<double>(moment.total));
  if (moment.pointsPerSecond > 0.0) line += formatted("  %.1f M/s", 1e-6 * moment.pointsPerSecond);
  line += "  " + bytesText(static_cast<double>(moment.memoryBytes));
  line += moment.secondsLeft ? "  " + durationText(*moment.secondsLeft) + " left"
                             : "  " + durationText(moment.elapsedSeconds) + " so far";
  return line;
}

std::string progressJson(const ProgressMoment& moment) {
  nlohmann::ordered_json json{
      {"progress", moment.stage},           {"points_done", moment.done},
      {"points_total", moment.total},       {"points_per_second", std::round(moment.pointsPerSecond)},
      {"memory_bytes", moment.memoryBytes}, {"seconds", moment.elapsedSeconds}};
  if (moment.secondsLeft) json["seconds_left"] = *moment.secondsLeft;
  return json.dump();
}

ProgressDisplay::ProgressDisplay(Style style, std::FILE* out, int threads, std::chrono::milliseconds interval)
    : style_(style),
      out_(out),
      threads_(threads),
      interval_(style == Style::terminal ? kTerminalInterval : interval),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

ProgressDisplay::~ProgressDisplay() {
  thread_.request_stop();
  thread_.join();
  if (!shown_ || style_ != Style::terminal) return;
  std::fputs("\r\033[K", out_);
  std::fflush(out_);
}

void ProgressDisplay::update(const Progress& progress) {
  const MutexLock lock(mutex_);
  const bool same = std::string_view(latest_.stage) == progress.stage;
  if (!same) {
    stageBegin_ = Clock::now();
    stageFirst_ = progress.done;
  }
  // Threads report out of order; another total is another scan.
  const bool later = same && latest_.total == progress.total;
  const std::uint64_t done = later ? std::max(latest_.done, progress.done) : progress.done;
  latest_ = progress;
  latest_.done = done;
  points_ = std::max(points_, progress.total);
}

ProgressMoment ProgressDisplay::moment() const {
  const auto now = Clock::now();
  const auto since = [now](Clock::time_point then) { return std::chrono::duration<double>(now - then).count(); };
  const double stageSeconds = since(stageBegin_);
  Progress here = latest_;
  here.done -= std::min(here.done, stageFirst_);
  here.total -= std::min(here.total, stageFirst_);
  ProgressMoment out{latest_.stage,
                     latest_.done,
                     latest_.total,
                     0.0,
                     0,
                     since(begin_),
                     secondsLeft(here, stageSeconds, points_, threads_)};
  if (here.done > 0 && stageSeconds > 0.0) out.pointsPerSecond = static_cast<double>(here.done) / stageSeconds;
  return out;
}

void ProgressDisplay::print(const ProgressMoment& moment) {
  if (style_ == Style::terminal) {
    const std::string line = progressLine(moment).substr(0, columnsOf(out_) - 1);
    std::fprintf(out_, "\r%s\033[K", line.c_str());
  } else {
    std::fprintf(out_, "%s\n", (style_ == Style::json ? progressJson(moment) : progressLine(moment)).c_str());
  }
  std::fflush(out_);
  shown_ = true;
}

void ProgressDisplay::run(const std::stop_token& stop) {
  MutexLock lock(mutex_);
  while (!wake_.wait_for(mutex_, stop, interval_, [&] { return stop.stop_requested(); })) {
    ProgressMoment now = moment();
    lock.unlock();
    now.memoryBytes = residentBytes();
    if (!now.stage.empty()) print(now);
    lock.lock();
  }
}

}  // namespace strata
