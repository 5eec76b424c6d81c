#include "viewer/bench/bench_options.h"

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>

#include "core/error.h"
#include "core/program/command_line.h"
#include "core/version.h"
#include "render/create_rasterizer.h"
#include "viewer/session/picture_size.h"

namespace strata {
namespace {

constexpr int kMostLoaders = 64;

/// The words of the command line, before names become values.
struct RawOptions {
  std::string backend = "auto", size = "1920x1080", occlusion = "on", failAbove;
};

void addRunOptions(CLI::App& app, BenchOptions& o, RawOptions& raw) {
  app.add_option("store", o.store, "the store, NAME.strata");
  app.add_option("--path", o.path, "camera path to play, JSON");
  app.add_option("--make-path", o.makePath, "print a camera path: orbit, flythrough, dive or street")
      ->check(CLI::IsMember({"orbit", "flythrough", "dive", "street"}));
  app.add_flag("--stills", o.stills, "write overview.png, close.png and detail.png");
  app.add_option("-o,--output", o.output, "folder for the report and the pictures");
  app.add_option("--backend", raw.backend, backendChoices())->capture_default_str();
  app.add_option("--size", raw.size, "size of the picture in pixels")->capture_default_str();
  app.add_option("--point-budget", o.streamer.selection.pointBudget, "largest number of points in a frame")
      ->check(CLI::Range(std::uint64_t{1}, SelectionOptions::kMaxPointBudget))
      ->capture_default_str();
  app.add_option("--points-per-pixel", o.streamer.selection.pointsPerPixel, "wanted density of points on the screen")
      ->check(CLI::Range(0.001, 1000.0))
      ->capture_default_str();
  app.add_option("--point-size", o.pointSize, "side of a point in pixels")
      ->check(CLI::Range(1, DrawOptions::kLargestPoint))
      ->capture_default_str();
  app.add_flag("--edl", o.edl, "eye-dome lighting");
  addDrawFlags(app, o.draw);
  addProgressiveFlags(app, o.progressive);
  app.add_option("--occlusion", raw.occlusion,
                 "on: closed surfaces hide the nodes behind them; exact: only if they leave no pixel open; off")
      ->check(CLI::IsMember({"on", "exact", "off"}))
      ->capture_default_str();
  app.add_option("--loader-threads", o.streamer.loaderThreads, "threads that read nodes")
      ->check(CLI::Range(1, kMostLoaders))
      ->capture_default_str();
  app.add_option("--cache", o.streamer.cacheBytes, "memory for decoded nodes, such as 512M or 2G")
      ->transform(CLI::AsSizeValue(false));
  app.add_flag("--cold", o.cold, "drop points.bin from the system's page cache first (posix_fadvise)");
  app.add_flag("--settle", o.settle, "wait for full detail before every frame instead of flying in real time");
  app.add_option("--repeat", o.repeat,
                 "fly N times, each time from empty caches; the report has the medians and the noise")
      ->check(CLI::Range(1, 1000));
  app.add_option("--video", o.video, "write a film of the flight, such as flight.mp4, with ffmpeg; implies --settle");
  app.add_option("--screenshot-every", o.screenshotEvery, "write a PNG of every N-th frame")
      ->check(CLI::Range(1, 1000000));
  app.add_flag("!--no-trace", o.trace, "write no trace.json");
  app.add_flag("--json", o.json, "print the measures as one JSON object");
}

void checkRun(const BenchOptions& o) {
  if (o.store.empty()) throw UsageError("NAME.strata is missing (see --help)");
  if (!o.makePath.empty()) return;
  if (o.path.empty() && !o.stills) throw UsageError("nothing to do: --path, --stills or --make-path is missing");
  if (o.output.empty()) throw UsageError("-o DIR is missing");
  if (!o.video.empty() && o.path.empty()) throw UsageError("--video needs --path");
  if (o.json && o.path.empty()) throw UsageError("--json needs --path: stills have no measures");
}

}  // namespace

double parsePercent(const std::string& text) {
  const char* end = text.data() + text.size();
  double percent = 0.0;
  const auto [rest, failure] = std::from_chars(text.data(), end, percent);
  const bool whole = rest == end || (rest + 1 == end && *rest == '%');
  if (failure != std::errc() || !whole || !std::isfinite(percent) || percent < 0.0)
    throw UsageError("--fail-above", "found " + text + " (expected a percentage such as 5%)");
  return percent / 100.0;
}

std::optional<BenchOptions> parseBenchOptions(int argc, const char* const* argv) {
  BenchOptions options;
  RawOptions raw;
  CLI::App app{"Flies a camera path through a store and measures the frames.", "strata-bench"};
  app.set_version_flag("--version", "strata-bench " + version());
  addRunOptions(app, options, raw);
  CLI::App* compare = app.add_subcommand("compare", "compare the measures of two runs");
  compare->add_option("A", options.reportA, "folder or report.json of the first run")->required();
  compare->add_option("B", options.reportB, "folder or report.json of the second run")->required();
  compare->add_option("-o,--output", options.comparison,
                      "also write a page with the pictures side by side, such as compare.html");
  compare->add_option("--fail-above", raw.failAbove, "exit with 1 when B is worse by more than this, such as 5%");
  if (!parseCommandLine(app, argc, argv)) return std::nullopt;
  OcclusionOptions& occlusion = options.streamer.selection.occlusion;
  if (raw.occlusion == "exact") occlusion = OcclusionOptions::exact();
  occlusion.enabled = raw.occlusion != "off";
  options.backend = parseBackend(raw.backend);
  checkProgressive(options.progressive, raw.backend, options.draw);
  options.size = parseSize(raw.size);
  options.colour = colourOf(options.draw);
  DrawOptions checked;
  applyDrawFlags(options.draw, checked);
  if (!raw.failAbove.empty()) options.failAbove = parsePercent(raw.failAbove);
  if (compare->parsed()) {
    options.command = BenchOptions::Command::compare;
  } else {
    checkRun(options);
    options.settle = options.settle || !options.video.empty();
    if (!options.makePath.empty()) options.command = BenchOptions::Command::makePath;
  }
  return options;
}

}  // namespace strata
