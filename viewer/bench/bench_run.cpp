#include "viewer/bench/bench_run.h"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <numeric>

#include "core/error.h"
#include "core/log.h"
#include "core/percentile.h"
#include "core/readable.h"
#include "core/version.h"
#include "io/file/text_file.h"
#include "viewer/bench/jump_watch.h"
#include "viewer/bench/page_cache.h"
#include "viewer/bench/path_player.h"
#include "viewer/bench/trace_file.h"
#include "viewer/camera/stills.h"

namespace strata {
namespace {

constexpr double kNearShare = 1e-4;           // of the scan's diagonal, for scans smaller than a room
constexpr double kNear = 0.01;                // metres
constexpr double kStillPointsPerPixel = 4.0;  // leaves no pinholes
constexpr double kWidestSpacingPx = 6.5;      // between points in a still; beyond, the camera steps back ...
constexpr double kWantedSpacingPx = 5.0;      // ... for this
constexpr int kStepsBack = 3;

using Facts = std::vector<std::pair<std::string, std::string>>;

std::string utcNow() {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text;
}

std::string storeName(const std::string& path) {
  std::filesystem::path folder = std::filesystem::path(path).lexically_normal();
  if (!folder.has_filename()) folder = folder.parent_path();
  return folder.stem().string();
}

Facts storeFacts(const Store& store) {
  const StoreInfo& info = store.info();
  char size[96];
  const glm::dvec3 extent = info.bounds.size();
  std::snprintf(size, sizeof size, "%.6g × %.6g × %.6g m", extent.x, extent.y, extent.z);
  std::string attributes;
  for (const Attribute& attribute : info.layout.attributes())
    attributes += (attributes.empty() ? "" : ", ") + attribute.name;
  std::string sources;
  const std::size_t shown = std::min<std::size_t>(info.sources.size(), 4);
  for (std::size_t i = 0; i < shown; ++i)
    sources += (i == 0 ? "" : ", ") + std::filesystem::path(info.sources[i].path).filename().string() + " (" +
               info.sources[i].format + ")";
  if (info.sources.size() > shown) sources += " and " + std::to_string(info.sources.size() - shown) + " more";
  return {{"points", readableCount(static_cast<double>(info.points))},
          {"nodes", readableCount(static_cast<double>(info.nodes))},
          {"levels", std::to_string(info.levels)},
          {"extent", size},
          {"points.bin", readableBytes(static_cast<double>(store.points().size()))},
          {"attributes", attributes.empty() ? "none" : attributes},
          {"sources", sources.empty() ? "unknown" : sources},
          {"made by", info.program}};
}

std::string occlusionName(const OcclusionOptions& occlusion) {
  if (!occlusion.enabled) return "off";
  return occlusion == OcclusionOptions::exact() ? "exact" : "on";
}

template <class Numbers>
std::string numbersText(const Numbers& numbers) {
  std::string text;
  for (const double number : numbers) {
    char one[32];
    std::snprintf(one, sizeof one, "%s%.9g", text.empty() ? "" : " ", number);
    text += one;
  }
  return text;
}

template <class Shapes>
std::string shapesText(const Shapes& shapes) {
  std::string text;
  for (const auto& shape : shapes) text += (text.empty() ? "" : "; ") + numbersText(shape);
  return text.empty() ? "none" : text;
}

Facts optionFacts(const BenchOptions& o, const DrawOptions& draw, const std::string& pageCache) {
  char density[32];
  std::snprintf(density, sizeof density, "%g", o.streamer.selection.pointsPerPixel);
  const auto orElse = [](const std::string& text, const char* otherwise) { return text.empty() ? otherwise : text; };
  return {
      {"path", o.path.empty() ? "none" : std::filesystem::path(o.path).filename().string()},
      {"path hash", o.path.empty() ? "none" : textHash(readText(o.path))},
      {"size", std::to_string(o.size.width) + "x" + std::to_string(o.size.height)},
      {"point budget", readableCount(static_cast<double>(o.streamer.selection.pointBudget))},
      {"progressive", o.progressive.millions > 0.0 ? readableCount(1e6 * o.progressive.millions) + " a frame" : "no"},
      {"points a pixel", density},
      {"point size", std::to_string(draw.pointSize)},
      {"colour", colourName(draw.colour)},
      {"values shown", orElse(numbersText(o.draw.range), "all")},
      {"classes", orElse(o.draw.classes, "all")},
      {"clip boxes", shapesText(o.draw.clipBoxes)},
      {"clip planes", shapesText(o.draw.clipPlanes)},
      {"background", orElse(o.draw.background, "as it is")},
      {"holes filled", o.draw.fill},
      {"occlusion", occlusionName(o.streamer.selection.occlusion)},
      {"shading", draw.shading == Shading::highQuality ? "high quality" : "plain"},
      {"eye-dome lighting", draw.edl ? "yes" : "no"},
      {"loader threads", std::to_string(o.streamer.loaderThreads)},
      {"cache", readableBytes(static_cast<double>(o.streamer.cacheBytes))},
      {"frames wait for detail", o.settle ? "yes" : "no"},
      {"repetitions", std::to_string(o.repeat)},
      {"page cache", pageCache}};
}

FrameStage stage(const std::string& name, const std::vector<FrameRecord>& frames, double FrameRecord::*member,
                bool onRenderThread) {
  std::vector<double> values;
  double sum = 0.0;
  for (const FrameRecord& frame : frames) {
    values.push_back(frame.*member);
    sum += values.back();
  }
  const double mean = frames.empty() ? 0.0 : sum / static_cast<double>(frames.size());
  return {name, mean, percentile(values, 95.0), onRenderThread};
}

std::vector<std::pair<std::string, double>> counters(const StreamerStats& s) {
  const auto count = [](std::uint64_t value) { return static_cast<double>(value); };
  return {{"nodes loaded", count(s.nodesLoaded)},
          {"points loaded", count(s.pointsLoaded)},
          {"bytes read", count(s.bytesRead)},
          {"failures", count(s.failures)},
          {"nodes given up", count(s.nodesGivenUp)},
          {"loads dropped", count(s.loadsDropped)},
          {"cache hits", count(s.cacheHits)},
          {"cache misses", count(s.cacheMisses)},
          {"evictions", count(s.evictions)},
          {"refusals", count(s.refusals)},
          {"duplicates", count(s.duplicates)},
          {"over capacity", count(s.overCapacity)},
          {"reads", count(s.reads)},
          {"nodes loaded ahead", count(s.nodesAhead)},
          {"nodes hidden at the end", count(s.occluded)},
          {"LOD passes", count(s.lodPasses)},
          {"peak resident bytes", count(s.peakResidentBytes)}};
}

/// One flight, begun with empty caches.
struct Flight {
  PlayedPath played;
  BenchMeasures measures;
  std::vector<std::pair<std::string, double>> counters;
  std::unique_ptr<Trace> trace;  ///< null where none is wanted
};

std::uint64_t peakRssBytes() {
  rusage usage{};
  return getrusage(RUSAGE_SELF, &usage) == 0 ? static_cast<std::uint64_t>(usage.ru_maxrss) * 1024 : 0;
}

Flight flyOnce(const BenchOptions& options, const CameraPath& path, const std::shared_ptr<const Store>& store,
               Rasterizer& rasterizer, PlayOptions play) {
  Flight flight;
  StreamerOptions streaming = options.streamer;
  streaming.selection.shown = shownBy(play.draw);
  if (options.trace) {
    flight.trace = std::make_unique<Trace>();
    play.lane = &flight.trace->addLane("render");
    streaming.trace = flight.trace.get();
  }
  Streamer streamer(store, streaming);
  const CpuTime cpuBefore = cpuTime();
  const auto began = std::chrono::steady_clock::now();
  flight.played = playPath(path, play, streamer, rasterizer);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  const double others = cpuOfOthers(cpuBefore, cpuTime(), seconds);
  if (!flight.played.reachedFullDetail) logWarning("the first view did not reach full detail in time");
  const StreamerStats stats = streamer.stats();
  flight.measures = measureFrames(flight.played.frames);
  flight.measures.backend = rasterizer.name();
  flight.measures.device = rasterizer.device();
  flight.measures.timeToFullDetailMs = flight.played.timeToFullDetailMs;
  flight.measures.lodMs = stats.lodMsMean;
  flight.measures.cacheHitRate = stats.hitRate();
  flight.measures.peakRssBytes = peakRssBytes();
  flight.measures.cpuOfOthers = others;
  double pixels = 0.0;
  for (const FrameRecord& frame : flight.played.frames) pixels += static_cast<double>(frame.pixelsCovered);
  if (pixels > 0.0) flight.measures.pointsReadPerPixel = static_cast<double>(stats.pointsLoaded) / pixels;
  flight.counters = counters(stats);
  return flight;
}

/// The run whose median frame time is the (lower) median one.
std::size_t typicalRun(const std::vector<BenchMeasures>& runs) {
  std::vector<std::size_t> order(runs.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return runs[a].p50Ms < runs[b].p50Ms; });
  return order[(order.size() - 1) / 2];
}

/// Asks for the page cache to be emptied of the store's points; says how far that went.
std::string dropPages(const Store& store) {
  char text[80];
  std::snprintf(text, sizeof text, "cold: points.bin dropped (posix_fadvise), %.0f %% stayed",
                100.0 * dropFromPageCache(store.points().name()));
  logInfo(std::string("page cache: ") + text);
  return text;
}

std::string pagesAsTheyAre(const Store& store) {
  char text[80];
  std::snprintf(text, sizeof text, "left as it was: %.0f %% of points.bin in memory at the start",
                100.0 * shareInPageCache(store.points().name()));
  return text;
}

/// Flies options.repeat times; the report gets the median of each measure, and frames and pictures of the typical run.
/// Pictures and film are taken in the first run alone, so that the others have nothing to do but fly.
void flyPath(const BenchOptions& options, const std::shared_ptr<const Store>& store, Rasterizer& rasterizer,
             const DrawOptions& draw, BenchReport& report) {
  const CameraPath path = readCameraPath(options.path);
  const double nearPlane = std::min(kNear, kNearShare * store->info().bounds.diagonal());
  std::vector<Flight> flights;
  std::vector<std::vector<JumpRecord>> jumps;
  for (int run = 0; run < options.repeat; ++run) {
    PlayOptions play{options.size, draw, options.settle, 0, options.output, {}, nearPlane};
    if (run == 0) {
      play.screenshotEvery = options.screenshotEvery;
      play.video = options.video;
    }
    play.pictures = run == 0;
    play.store = store.get();
    if (options.cold && run > 0) dropPages(*store);
    flights.push_back(flyOnce(options, path, store, rasterizer, play));
    report.runs.push_back(flights.back().measures);
    jumps.push_back(flights.back().played.jumps);
    if (options.repeat > 1)
      logInfo("run " + std::to_string(run + 1) + " of " + std::to_string(options.repeat) + ": median frame " +
              readableMs(flights.back().measures.p50Ms));
  }
  report.measures = medianMeasures(report.runs);
  Flight& typical = flights[typicalRun(report.runs)];
  report.pictures = std::move(flights.front().played.pictures);
  report.frames = std::move(typical.played.frames);
  report.jumps = medianJumps(jumps);
  report.counters = std::move(typical.counters);
  if (typical.trace != nullptr) writeText(options.output + "/trace.json", traceJson(*typical.trace, report.program));
  report.stages = {stage("taking the render list", report.frames, &FrameRecord::listMs, true),
                   stage("upload", report.frames, &FrameRecord::uploadMs, true),
                   stage("drawing", report.frames, &FrameRecord::drawMs, true),
                   stage("resolve to colour", report.frames, &FrameRecord::resolveMs, true),
                   stage("LOD pass, on its own thread", report.frames, &FrameRecord::lodMs, false)};
  if (report.measures.gpuMs > 0.0)
    report.stages.push_back(stage("of drawing, by the GPU's clock", report.frames, &FrameRecord::gpuMs, false));
}

/// A still of full detail. Where the scan is too sparse for a place so near, the camera steps back, at most to
/// `farthest` metres.
Image takeStill(Still still, double farthest, DrawOptions draw, Streamer& streamer, Rasterizer& rasterizer) {
  DrawOptions bare = draw;
  bare.pointSize = 1;
  bare.fill = 1;
  bare.jumpFlood = bare.edl = false;
  FrontSpacing spacing;
  for (int step = 0; step < kStepsBack; ++step) {
    spacing = frontSpacing(drawComplete(still.view, bare, streamer, rasterizer), still.view);
    const double factor = std::min(spacing.pixels / kWantedSpacingPx, farthest / still.subject);
    if (spacing.pixels <= kWidestSpacingPx || factor <= 1.05) break;
    still = fartherStill(still, factor);
  }
  draw.pointSize = draw.jumpFlood ? 1 : closedPointSize(spacing.pixels);
  draw.pointMetres = draw.jumpFlood ? 0.0f : closedPointMetres(spacing.metres);
  draw.edl = true;
  return imageOf(drawComplete(still.view, draw, streamer, rasterizer));
}

/// The three pictures, before those of the flight.
void takeStills(const BenchOptions& options, const std::shared_ptr<const Store>& store, Rasterizer& rasterizer,
                BenchReport& report) {
  const ScanSample scan = sampleStore(*store);
  StreamerOptions rich = options.streamer;
  rich.selection.pointsPerPixel = std::max(rich.selection.pointsPerPixel, kStillPointsPerPixel);
  DrawOptions draw = drawOptionsFor(store->info(), scan.bounds, options.colour);
  applyDrawFlags(options.draw, draw);
  // A map of heights is read by its relief, which splats smooth away.
  if (options.draw.fill.empty()) draw.jumpFlood = draw.colour != ColourMode::elevation;
  rich.selection.shown = shownBy(draw);
  Streamer streamer(store, rich);
  std::vector<ReportPicture> pictures;
  double farthest = 0.0;  // the overview stays where it is, each one after it nearer than the one before
  for (const Still& still : chooseStills(scan, *store, options.size.width, options.size.height)) {
    pictures.push_back(
        {still.name, still.name + ".png", false, takeStill(still, farthest, draw, streamer, rasterizer)});
    writePng(options.output + "/" + pictures.back().file, pictures.back().image);
    pictures.back().hash = imageHash(pictures.back().image);
    farthest = scan.enclosed ? 0.0 : 0.7 * still.subject;
  }
  report.pictures.insert(report.pictures.begin(), pictures.begin(), pictures.end());
}

}  // namespace

BenchReport runBench(const BenchOptions& options) {
  const auto store = std::make_shared<const Store>(options.store);
  const std::unique_ptr<Rasterizer> rasterizer = createWindowlessRasterizer(
      options.backend,
      progressiveOptions(options.progressive, options.streamer.selection.pointBudget, store->info().points));
  makeFolder(options.output);

  const std::string pageCache = options.cold ? dropPages(*store) : pagesAsTheyAre(*store);
  DrawOptions draw = drawOptionsFor(store->info(), store->info().bounds, options.colour);
  applyDrawFlags(options.draw, draw);
  draw.pointSize = options.pointSize;
  draw.edl = options.edl;

  BenchReport report;
  report.program = "strata-bench " + version();
  report.commit = commit();
  report.when = utcNow();
  report.storePath = options.store;
  report.storeName = storeName(options.store);
  report.storeHash = storeHash(*store);
  report.store = storeFacts(*store);
  report.options = optionFacts(options, draw, pageCache);
  report.machine = thisMachine();
  report.measures.backend = rasterizer->name();
  report.measures.device = rasterizer->device();
  if (!options.path.empty()) flyPath(options, store, *rasterizer, draw, report);
  if (options.stills) takeStills(options, store, *rasterizer, report);
  writeReport(options.output, report);
  return report;
}

}  // namespace strata
