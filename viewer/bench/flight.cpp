#include "viewer/bench/flight.h"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <numeric>

#include "core/log.h"
#include "core/percentile.h"
#include "core/readable.h"
#include "io/file/text_file.h"
#include "viewer/bench/jump_watch.h"
#include "viewer/bench/page_cache.h"
#include "viewer/bench/path_player.h"
#include "viewer/bench/trace_file.h"

namespace strata {
namespace {

constexpr double kNearShare = 1e-4;  // of the scan's diagonal, for scans smaller than a room
constexpr double kNear = 0.01;       // metres

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

}  // namespace

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

}  // namespace strata
