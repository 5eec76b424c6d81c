#include "viewer/measures.h"

#include <algorithm>
#include <nlohmann/json.hpp>

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
  double seconds = 0.0;
  for (const FrameRecord& frame : frames) {
    times.push_back(frame.frameMs);
    points += static_cast<double>(frame.pointsDrawn);
    seconds += frame.frameMs / 1000.0;
    measures.hitches += frame.hitch ? 1 : 0;
  }
  measures.p50Ms = percentile(times, 50.0);
  measures.p95Ms = percentile(times, 95.0);
  measures.p99Ms = percentile(times, 99.0);
  measures.maxMs = percentile(times, 100.0);
  measures.pointsPerSecond = seconds > 0.0 ? points / seconds : 0.0;
  measures.pointsDrawnMean = points / static_cast<double>(frames.size());
  measures.bytesRead = frames.back().bytesRead;
  return measures;
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
  json["backend"] = m.backend;
  json["device"] = m.device;
  return json.dump();
}

}  // namespace strata
