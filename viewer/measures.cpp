#include "viewer/measures.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <type_traits>

namespace strata {

bool isHitch(double previousMs, double frameMs) { return frameMs > kHitchMs && frameMs > kHitchRatio * previousMs; }

double percentile(std::span<const double> values, double p) {
  if (values.empty()) return 0.0;
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  const double rank = std::clamp(p, 0.0, 100.0) / 100.0 * static_cast<double>(sorted.size() - 1);
  const std::size_t below = static_cast<std::size_t>(rank);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (rank - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

BenchMeasures measureFrames(std::span<const FrameRecord> frames) {
  BenchMeasures measures;
  measures.frames = static_cast<int>(frames.size());
  if (frames.empty()) return measures;
  std::vector<double> times;
  double points = 0.0;
  double seconds = 0.0, hitchSeconds = 0.0;
  double pixels = 0.0;
  for (const FrameRecord& frame : frames) {
    times.push_back(frame.frameMs);
    points += static_cast<double>(frame.pointsDrawn);
    seconds += frame.frameMs / 1000.0;
    measures.hitches += frame.hitch ? 1 : 0;
    hitchSeconds += frame.hitch ? frame.frameMs / 1000.0 : 0.0;
    pixels += static_cast<double>(frame.pixelsCovered);
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
  return measures;
}

namespace {

/// A measure that runs are compared by.
struct Field {
  const char* name;
  double (*get)(const BenchMeasures&);
  void (*set)(BenchMeasures&, double);
};

template <auto Member>
constexpr Field field(const char* name) {
  return {name, [](const BenchMeasures& m) { return static_cast<double>(m.*Member); },
          [](BenchMeasures& m, double value) {
            using Value = std::remove_reference_t<decltype(m.*Member)>;
            m.*Member = static_cast<Value>(std::is_integral_v<Value> ? std::round(value) : value);
          }};
}

using M = BenchMeasures;
constexpr Field kFields[] = {field<&M::p50Ms>("frame_ms p50"),
                             field<&M::p95Ms>("frame_ms p95"),
                             field<&M::p99Ms>("frame_ms p99"),
                             field<&M::maxMs>("frame_ms max"),
                             field<&M::pointsPerSecond>("points_per_second"),
                             field<&M::pointsDrawnMean>("points_drawn_mean"),
                             field<&M::timeToFullDetailMs>("time_to_full_detail_ms"),
                             field<&M::lodMs>("lod_ms"),
                             field<&M::bytesRead>("bytes_read"),
                             field<&M::cacheHitRate>("cache_hit_rate"),
                             field<&M::hitches>("hitches"),
                             field<&M::hitchesPerMinute>("hitches_per_minute"),
                             field<&M::hitchTimeShare>("hitch_time_share"),
                             field<&M::pointsPerPixelWon>("points_per_pixel_won"),
                             field<&M::peakRssBytes>("peak_rss_bytes"),
                             field<&M::gpuPeakBytes>("gpu_peak_bytes")};

std::vector<double> valuesOf(std::span<const BenchMeasures> runs, const Field& f) {
  std::vector<double> values;
  for (const BenchMeasures& run : runs) values.push_back(f.get(run));
  return values;
}

}  // namespace

BenchMeasures medianMeasures(std::span<const BenchMeasures> runs) {
  BenchMeasures median = runs.empty() ? BenchMeasures{} : runs.front();
  for (const Field& f : kFields) f.set(median, percentile(valuesOf(runs, f), 50.0));
  return median;
}

std::vector<MeasureNoise> measureNoise(std::span<const BenchMeasures> runs) {
  std::vector<MeasureNoise> noise;
  if (runs.size() < 2) return noise;
  for (const Field& f : kFields) {
    const std::vector<double> values = valuesOf(runs, f);
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    const double median = percentile(values, 50.0);
    noise.push_back({f.name, median > 0.0 ? (*most - *least) / median : 0.0});
  }
  return noise;
}

std::string measuresJson(const BenchMeasures& m) {
  nlohmann::ordered_json json;
  json["frames"] = m.frames;
  json["frame_ms"] = {{"p50", m.p50Ms}, {"p95", m.p95Ms}, {"p99", m.p99Ms}, {"max", m.maxMs}};
  json["points_per_second"] = m.pointsPerSecond;
  json["points_drawn_mean"] = m.pointsDrawnMean;
  json["time_to_full_detail_ms"] = m.timeToFullDetailMs;
  json["lod_ms"] = m.lodMs;
  json["bytes_read"] = m.bytesRead;
  json["cache_hit_rate"] = m.cacheHitRate;
  json["hitches"] = m.hitches;
  json["hitches_per_minute"] = m.hitchesPerMinute;
  json["hitch_time_share"] = m.hitchTimeShare;
  json["points_per_pixel_won"] = m.pointsPerPixelWon;
  json["peak_rss_bytes"] = m.peakRssBytes;
  json["gpu_peak_bytes"] = m.gpuPeakBytes;
  json["backend"] = m.backend;
  json["device"] = m.device;
  return json.dump();
}

}  // namespace strata
