#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "converter/convert.h"
#include "converter/programs/conversion_summary.h"
#include "converter/programs/plan.h"
#include "converter/programs/progress_display.h"
#include "core/error.h"
#include "core/program/command_line.h"
#include "core/program/exit_code.h"
#include "core/program/stop_signal.h"
#include "core/version.h"

namespace strata {
namespace {

/// Every input stays open, and a scan may have thousands of tiles.
void allowManyFiles() {
  rlimit files{};
  if (::getrlimit(RLIMIT_NOFILE, &files) != 0) return;
  files.rlim_cur = files.rlim_max;
  ::setrlimit(RLIMIT_NOFILE, &files);
}

/// The cap is on resident memory, so freed blocks of points go back to the system at once.
void returnFreedMemory() { ::mallopt(M_MMAP_THRESHOLD, 1 << 20); }

/// Progress is one line on a terminal, and lines on stderr otherwise, so that stdout holds the result alone.
ProgressDisplay::Style progressStyle(bool json) {
  if (json) return ProgressDisplay::Style::json;
  return ::isatty(STDERR_FILENO) != 0 ? ProgressDisplay::Style::terminal : ProgressDisplay::Style::lines;
}

/// Warnings go to stdout unless stderr is a terminal, because a program that reads stderr expects an error there.
void showWarning(ProgressDisplay::Style style, const std::string& message) {
  if (style == ProgressDisplay::Style::terminal)
    std::fprintf(stderr, "\r\033[Kwarning: %s\n", message.c_str());
  else if (style == ProgressDisplay::Style::lines)
    std::printf("warning: %s\n", message.c_str());
  else
    std::printf("%s\n", warningJson(message).c_str());
}

/// The command line with --resume added, quoted for a shell.
std::string resumeCommand(int argc, char** argv) {
  std::string command;
  bool resumes = false;
  for (int i = 0; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--force") continue;  // would start again
    resumes = resumes || word == "--resume";
    const bool plain = !word.empty() && word.find_first_not_of(
                                            "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"
                                            "0123456789-_./=,:+%@") == std::string::npos;
    command += i > 0 ? " " : "";
    if (plain) {
      command += word;
      continue;
    }
    command += '\'';
    for (const char c : word) command += c == '\'' ? std::string("'\\''") : std::string(1, c);
    command += '\'';
  }
  return resumes ? command : command + " --resume";
}

int run(int argc, char** argv) {
  CLI::App app("Converts laser scans to a Strata store.", "strata-convert");
  ConvertOptions options;
  std::string memory = "2G";
  bool json = false, plan = false;
  app.add_option("INPUT", options.inputs, "scan files, folders, or synthetic:NAME?points=1e6&seed=1")->required();
  app.add_option("-o,--output", options.output, "the store to make, NAME.strata");
  app.add_option("--memory", memory, "most memory to use, at least 512M")->capture_default_str();
  app.add_option("--threads", options.threads, "0 = all cores")->check(CLI::Range(0, 1024))->capture_default_str();
  app.add_option("--node-points", options.nodePoints, "points a node holds")
      ->check(CLI::Range(kLeastNodePoints, kMostNodePoints))
      ->capture_default_str();
  std::string lodColour = "first";
  app.add_option(
         "--lod-colour", lodColour,
         "the colour of points in coarse levels: first, their own, or average, the mean of those they represent")
      ->check(CLI::IsMember({"first", "average"}))
      ->capture_default_str();
  app.add_option("--temp", options.tempFolder, "folder for temporary points (default: beside the store)");
  app.add_option("--columns", options.source.columns,
                 "columns of text files, as in x,y,z,intensity,r,g,b; - skips one");
  app.add_flag("--skip-damaged", options.source.skipDamaged, "convert what is sound of a damaged scan");
  app.add_flag("--resume", options.resume, "go on with an interrupted conversion, if there is one");
  app.add_flag("--force", options.force, "replace an existing store; start an interrupted conversion again");
  app.add_flag("--normals", options.normals, "estimate normals for scans that have none");
  app.add_flag("--plan", plan, "say what the conversion would take, and convert nothing; -o and --temp name the disks");
  app.add_flag("--json", json, "print one JSON object as the last line; progress as JSON lines on stderr");
  double progressSeconds = 10.0;
  app.add_option("--progress-every", progressSeconds,
                 "seconds between two lines of progress where stderr is no terminal")
      ->check(CLI::Range(0.1, 3600.0))
      ->capture_default_str();
  app.set_version_flag("--version", version());
  if (!parseCommandLine(app, argc, argv)) return 0;
  if (!plan && app.count("--output") == 0) throw UsageError("--output is required");
  options.lodColour = lodColour == "average" ? LodColour::average : LodColour::first;
  options.memoryBytes = parseBytes("--memory", memory);
  if (options.memoryBytes < kLeastMemoryBytes)
    throw UsageError("--memory", "found " + memory + " (expected at least 512M)");

  listenForStop();
  allowManyFiles();
  returnFreedMemory();
  const auto begin = std::chrono::steady_clock::now();
  const ProgressDisplay::Style style = progressStyle(json);
  ConvertControl control;
  control.stop = &stopAsked();
  control.warn = [style](const std::string& message) { showWarning(style, message); };
  if (plan) {
    const ConversionPlan planned = planConversion(options, control);
    std::fputs(json ? (planJson(planned) + "\n").c_str() : planText(planned, options).c_str(), stdout);
    flushOutput();
    return 0;
  }
  const auto converted = [&] {
    ProgressDisplay display(style, stderr, threadsOf(options),
                            std::chrono::milliseconds(std::llround(1000.0 * progressSeconds)));
    control.progress = [&display](const Progress& progress) { display.update(progress); };
    return convert(options, control);
  };
  ConvertReport report;
  try {
    report = converted();
  } catch (const Stopped&) {
    throw Error(options.output, "stopped; go on with: " + resumeCommand(argc, argv));
  }
  RunCost cost = runCost();
  cost.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  if (json)
    std::printf("%s\n", summaryJson(report, cost).c_str());
  else
    std::fputs(summaryText(options.output, report, cost).c_str(), stdout);
  flushOutput();
  return 0;
}

}  // namespace
}  // namespace strata

int main(int argc, char** argv) { return strata::exitCodeOf(strata::run, argc, argv); }
