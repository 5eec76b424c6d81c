#include <sys/resource.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <mutex>
#include <nlohmann/json.hpp>

#include "converter/command_line.h"
#include "converter/options.h"
#include "core/error.h"
#include "core/program.h"

namespace strata {
namespace {

/// Every input stays open: 119 tiles are common, thousands happen.
void allowManyFiles() {
  rlimit files{};
  if (::getrlimit(RLIMIT_NOFILE, &files) != 0) return;
  files.rlim_cur = files.rlim_max;
  ::setrlimit(RLIMIT_NOFILE, &files);
}

double seconds(const timeval& t) { return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec); }

/// One line on a terminal, rewritten; nothing at all elsewhere but the end of each stage.
class ProgressLine {
 public:
  ProgressLine() = default;
  ~ProgressLine() { end(); }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void show(const Progress& progress) {
    if (!terminal_) return;
    const std::lock_guard lock(mutex_);
    const auto now = std::chrono::steady_clock::now();
    if (now - last_ < std::chrono::milliseconds(200)) return;
    last_ = now;
    if (stage_ != progress.stage) {
      stage_ = progress.stage;
      stageBegin_ = now;
    }
    const double elapsed = std::chrono::duration<double>(now - stageBegin_).count();
    const double rate = elapsed > 0.0 ? static_cast<double>(progress.done) / elapsed : 0.0;
    const double share =
        progress.total > 0 ? static_cast<double>(progress.done) / static_cast<double>(progress.total) : 0.0;
    const double left =
        rate > 0.0 ? static_cast<double>(progress.total - std::min(progress.total, progress.done)) / rate : 0.0;
    std::fprintf(stdout, "\r%-9s %5.1f %%  %s points  %.1f M points/s  %.0f s left   ", stage_.c_str(), 100.0 * share,
                 grouped(progress.done).c_str(), rate * 1e-6, left);
    std::fflush(stdout);
    shown_ = true;
  }
  void end() {
    if (shown_) std::fprintf(stdout, "\r%80s\r", "");
    shown_ = false;
  }

 private:
  const bool terminal_ = ::isatty(STDOUT_FILENO) != 0;
  std::mutex mutex_;
  std::chrono::steady_clock::time_point last_{};  ///< guarded by mutex_, as all below
  std::chrono::steady_clock::time_point stageBegin_{};
  std::string stage_;
  bool shown_ = false;
};

void printSummary(const ConvertOptions& options, const ConvertReport& report, double wall, const rusage& usage) {
  std::printf("%s: %s points in %s nodes, %.2f bytes a point, %.1f s (%.2f M points/s)\n", options.output.c_str(),
              grouped(report.points).c_str(), grouped(report.nodes).c_str(),
              static_cast<double>(report.outputBytes) / static_cast<double>(report.points), wall,
              static_cast<double>(report.points) / wall * 1e-6);
  if (report.skipped > 0) std::printf("skipped %s points\n", grouped(report.skipped).c_str());
  for (const ConvertReport::Stage& stage : report.stages)
    std::printf("  %-10s %8.2f s\n", stage.name.c_str(), stage.seconds);
  std::printf("  cpu %.1f s, memory peak %ld MiB, temporary disk peak %.0f MiB\n",
              seconds(usage.ru_utime) + seconds(usage.ru_stime), usage.ru_maxrss / 1024,
              static_cast<double>(report.tempPeakBytes) / 1048576.0);
}

void printJson(const ConvertReport& report, double wall, const rusage& usage) {
  nlohmann::ordered_json stages;
  for (const ConvertReport::Stage& stage : report.stages) stages[stage.name] = stage.seconds;
  const nlohmann::ordered_json json{{"points", report.points},
                                    {"nodes", report.nodes},
                                    {"seconds", wall},
                                    {"points_per_second", static_cast<double>(report.points) / wall},
                                    {"cpu_seconds", seconds(usage.ru_utime) + seconds(usage.ru_stime)},
                                    {"peak_rss_bytes", static_cast<std::uint64_t>(usage.ru_maxrss) * 1024},
                                    {"input_bytes", report.inputBytes},
                                    {"output_bytes", report.outputBytes},
                                    {"temp_peak_bytes", report.tempPeakBytes},
                                    {"skipped", report.skipped},
                                    {"stages", stages}};
  std::printf("%s\n", json.dump().c_str());
}

int run(int argc, char** argv) {
  CLI::App app("Converts laser scans to a Strata store.", "strata-convert");
  ConvertOptions options;
  std::string memory = "2G";
  bool json = false, resume = false;
  app.add_option("INPUT", options.inputs, "scan files, folders, or synthetic:NAME?points=1e6&seed=1")->required();
  app.add_option("-o,--output", options.output, "the store to make, NAME.strata")->required();
  app.add_option("--memory", memory, "most memory to use, at least 512M")->capture_default_str();
  app.add_option("--threads", options.threads, "0 = all cores")->check(CLI::Range(0, 1024))->capture_default_str();
  app.add_option("--node-points", options.nodePoints, "points a node holds")
      ->check(CLI::Range(kLeastNodePoints, kMostNodePoints))
      ->capture_default_str();
  app.add_option("--temp", options.tempFolder, "folder for temporary points (default: beside the store)");
  app.add_option("--columns", options.source.columns,
                 "columns of text files, as in x,y,z,intensity,r,g,b; - skips one");
  app.add_flag("--skip-damaged", options.source.skipDamaged, "convert what is sound of a damaged scan");
  app.add_flag("--resume", resume, "take up an interrupted conversion: what it left is cleared and done again");
  app.add_flag("--force", options.force, "replace an existing store");
  app.add_flag("--json", json, "print one JSON object as the last line");
  if (!parseCommandLine(app, argc, argv)) return 0;
  options.memoryBytes = parseBytes("--memory", memory);
  if (options.memoryBytes < kLeastMemoryBytes)
    throw UsageError("--memory", "found " + memory + " (expected at least 512M)");

  listenForStop();
  allowManyFiles();
  ProgressLine line;
  ConvertControl control;
  control.stop = &stopAsked();
  if (!json) control.progress = [&line](const Progress& progress) { line.show(progress); };
  const auto begin = std::chrono::steady_clock::now();
  const ConvertReport report = convert(options, control);
  const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  line.end();
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  if (json)
    printJson(report, wall, usage);
  else
    printSummary(options, report, wall, usage);
  flushOutput();
  return 0;
}

}  // namespace
}  // namespace strata

int main(int argc, char** argv) {
  try {
    return strata::run(argc, argv);
  } catch (const std::exception& failure) {
    return strata::reportFailure(failure);
  }
}
