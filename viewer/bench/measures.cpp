#include "viewer/bench/measures.h"
#include "core/percentile.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <type_traits>
#include <utility>

namespace strata {

bool isHitch(double previousMs, double frameMs) { return frameMs > kHitchMs && frameMs > kHitchRatio * previousMs; }

BenchMeasures measureFrames(std::span<const FrameRecord> frames) {
  BenchMeasures measures;
  measures.frames = static_cast<int>(frames.size());
  if (frames.empty()) return measures;
  std::vector<double> times;
  double points = 0.0;
  double seconds = 0.0, hitchSeconds = 0.0;
  double pixels = 0.0, gpuMs = 0.0;
  std::vector<double> spacings;
  for (const FrameRecord& frame : frames) {
    times.push_back(frame.frameMs);
    points += static_cast<double>(frame.pointsDrawn);
    seconds += frame.frameMs / 1000.0;
    measures.hitches += frame.hitch ? 1 : 0;
    hitchSeconds += frame.hitch ? frame.frameMs / 1000.0 : 0.0;
    pixels += static_cast<double>(frame.pixelsCovered);
    gpuMs += frame.gpuMs;
    spacings.push_back(frame.widestSpacingPx);
    measures.gpuPeakBytes = std::max(measures.gpuPeakBytes, frame.gpuBytes);
  }
  measures.p50Ms = percentile(times, 50.0);
  measures.p95Ms = percentile(times, 95.0);
  measures.p99Ms = percentile(times, 99.0);
  measures.maxMs = percentile(times, 100.0);
  measures.pointsPerSecond = seconds > 0.0 ? points / seconds : 0.0;
  measures.pointsDrawnMean = points / static_cast<double>(frames.size());
  measures.bytesRead = frames.back().bytesRead;
  measures.hitchesPerMinute = seconds > 0.0 ? measures.hitches / (seconds / 60.0) : 0.0;
  measures.hitchTimeShare = seconds > 0.0 ? hitchSeconds / seconds : 0.0;
  measures.pointsPerPixelWon = pixels > 0.0 ? points / pixels : 0.0;
  measures.gpuMs = gpuMs / static_cast<double>(frames.size());
  measures.spacingP50 = percentile(spacings, 50.0);
  measures.spacingP95 = percentile(spacings, 95.0);
  return measures;
}

namespace {

using M = BenchMeasures;
using Better = MeasureField::Better;

template <auto Member>
constexpr MeasureField field(const char* name, const char* pointer, Better better) {
  using Value = std::remove_reference_t<decltype(std::declval<M&>().*Member)>;
  return {name,
          pointer,
          better,
          std::is_integral_v<Value>,
          [](const M& m) { return static_cast<double>(m.*Member); },
          [](M& m, double value) {
            m.*Member = static_cast<Value>(std::is_integral_v<Value> ? std::round(value) : value);
          }};
}

// The longest frame, what was drawn and what was held are shown but not judged: one is an accident of the machine, the
// others say what was drawn, not how well.
constexpr MeasureField kFields[] = {
    field<&M::p50Ms>("frame_ms p50", "/frame_ms/p50", Better::lower),
    field<&M::p95Ms>("frame_ms p95", "/frame_ms/p95", Better::lower),
    field<&M::p99Ms>("frame_ms p99", "/frame_ms/p99", Better::lower),
    field<&M::maxMs>("frame_ms max", "/frame_ms/max", Better::neither),
    field<&M::pointsPerSecond>("points_per_second", "/points_per_second", Better::higher),
    field<&M::pointsDrawnMean>("points_drawn_mean", "/points_drawn_mean", Better::neither),
    field<&M::timeToFullDetailMs>("time_to_full_detail_ms", "/time_to_full_detail_ms", Better::lower),
    field<&M::lodMs>("lod_ms", "/lod_ms", Better::lower),
    field<&M::gpuMs>("gpu_ms", "/gpu_ms", Better::lower),
    field<&M::bytesRead>("bytes_read", "/bytes_read", Better::lower),
    field<&M::cacheHitRate>("cache_hit_rate", "/cache_hit_rate", Better::higher),
    field<&M::hitches>("hitches", "/hitches", Better::lower),
    field<&M::hitchesPerMinute>("hitches_per_minute", "/hitches_per_minute", Better::neither),
    field<&M::hitchTimeShare>("hitch_time_share", "/hitch_time_share", Better::neither),
    field<&M::spacingP50>("widest_spacing_px p50", "/widest_spacing_px/p50", Better::neither),
    field<&M::spacingP95>("widest_spacing_px p95", "/widest_spacing_px/p95", Better::neither),
    field<&M::pointsPerPixelWon>("points_per_pixel_won", "/points_per_pixel_won", Better::neither),
    field<&M::pointsReadPerPixel>("points_read_per_pixel", "/points_read_per_pixel", Better::neither),
    field<&M::peakRssBytes>("peak_rss_bytes", "/peak_rss_bytes", Better::neither),
    field<&M::gpuPeakBytes>("gpu_peak_bytes", "/gpu_peak_bytes", Better::neither),
    field<&M::cpuOfOthers>("cpu_of_others", "/cpu_of_others", Better::neither)};

std::vector<double> valuesOf(std::span<const BenchMeasures> runs, const MeasureField& f) {
  std::vector<double> values;
  for (const BenchMeasures& run : runs) values.push_back(f.get(run));
  return values;
}

}  // namespace

BenchMeasures medianMeasures(std::span<const BenchMeasures> runs) {
  BenchMeasures median = runs.empty() ? BenchMeasures{} : runs.front();
  for (const MeasureField& f : kFields) f.set(median, percentile(valuesOf(runs, f), 50.0));
  return median;
}

std::vector<MeasureNoise> measureNoise(std::span<const BenchMeasures> runs) {
  std::vector<MeasureNoise> noise;
  if (runs.size() < 2) return noise;
  for (const MeasureField& f : kFields) {
    const std::vector<double> values = valuesOf(runs, f);
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    const double median = percentile(values, 50.0);
    noise.push_back({f.name, median > 0.0 ? (*most - *least) / median : 0.0});
  }
  return noise;
}

std::span<const MeasureField> measureFields() { return kFields; }

std::string measuresJson(const BenchMeasures& m) {
  nlohmann::ordered_json json;
  json["frames"] = m.frames;
  for (const MeasureField& f : kFields) {
    auto& value = json[nlohmann::ordered_json::json_pointer(f.pointer)];
    if (f.whole)
      value = static_cast<std::uint64_t>(f.get(m));
    else
      value = f.get(m);
  }
  json["backend"] = m.backend;
  json["device"] = m.device;
  return json.dump();
}

}  // namespace strata
