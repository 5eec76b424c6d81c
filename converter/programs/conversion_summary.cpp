#include "converter/programs/conversion_summary.h"

#include <sys/resource.h>

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string_view>

#include "converter/control.h"
#include "converter/journal/disk_room.h"
#include "core/readable.h"

namespace strata {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostPlaneLines = 8;  // the smallest planes share the last line

double ratio(double part, double whole) { return whole > 0.0 ? part / whole : 0.0; }

[[gnu::format(printf, 2, 3)]] void addLine(std::string& text, const char* format, ...) {
  char line[512];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(line, sizeof line, format, arguments);
  va_end(arguments);
  text.append(line).append("\n");
}

/// Keeps the largest planes and joins the others to one.
std::vector<PlaneSize> fewPlanes(std::vector<PlaneSize> planes) {
  std::stable_sort(planes.begin(), planes.end(),
                   [](const PlaneSize& a, const PlaneSize& b) { return a.bytes > b.bytes; });
  while (planes.size() > kMostPlaneLines) {
    PlaneSize& last = planes[planes.size() - 2];
    last.name = "others";
    last.rawBytes += planes.back().rawBytes;
    last.bytes += planes.back().bytes;
    planes.pop_back();
  }
  return planes;
}

void addStages(std::string& text, const ConvertReport& report, const RunCost& cost) {
  const auto points = static_cast<double>(report.points);
  addLine(text, "  %-11s %9s %9s %6s %11s %10s", "stage", "wall s", "cpu s", "cores", "M points/s", "us/point");
  const auto row = [&](const char* name, double wall, double cpu) {
    if (name == std::string_view(stage::kSurvey)) return addLine(text, "  %-11s %9.2f %9.2f", name, wall, cpu);
    addLine(text, "  %-11s %9.2f %9.2f %6.2f %11.2f %10.3f", name, wall, cpu, ratio(cpu, wall),
            1e-6 * ratio(points, wall), 1e6 * ratio(cpu, points));
  };
  for (const StageTime& stage : report.stages) row(stage.name.c_str(), stage.seconds, stage.cpuSeconds);
  row("total", cost.seconds, cost.cpuSeconds);
}

void addLevels(std::string& text, const ConvertReport& report) {
  std::string levels;
  for (std::size_t level = 0; level < report.nodesByLevel.size(); ++level)
    levels += (level > 0 ? ", " : "") + std::to_string(level) + ": " + grouped(report.nodesByLevel[level]);
  addLine(text, "  nodes by level  %s", levels.c_str());
}

void addPlanes(std::string& text, const ConvertReport& report) {
  const auto points = static_cast<double>(report.points);
  for (const PlaneSize& plane : fewPlanes(report.planes)) {
    const auto raw = static_cast<double>(plane.rawBytes), stored = static_cast<double>(plane.bytes);
    addLine(text, "  %-22s %6.2f of %5.2f bytes a point, %3.0f %%", plane.name.c_str(), ratio(stored, points),
            ratio(raw, points), 100.0 * ratio(stored, raw));
  }
}

}  // namespace

RunCost runCost() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  RunCost cost;
  cost.cpuSeconds = cpuSeconds();
  cost.peakMemoryBytes = static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
  return cost;
}

std::string summaryText(const std::string& output, const ConvertReport& report, const RunCost& cost) {
  const auto points = static_cast<double>(report.points);
  std::string text;
  addLine(text, "%s: %s points in %s nodes, %.2f bytes a point, %.1f s (%.2f M points/s)", output.c_str(),
          grouped(report.points).c_str(), grouped(report.nodes).c_str(),
          ratio(static_cast<double>(report.outputBytes), points), cost.seconds, 1e-6 * ratio(points, cost.seconds));
  if (report.skipped > 0) addLine(text, "skipped %s points", grouped(report.skipped).c_str());
  addStages(text, report, cost);
  addLevels(text, report);
  addPlanes(text, report);
  addLine(text, "  input %s, store %s, memory peak %s, temporary disk peak %s",
          bytesText(static_cast<double>(report.inputBytes)).c_str(),
          bytesText(static_cast<double>(report.outputBytes)).c_str(),
          bytesText(static_cast<double>(cost.peakMemoryBytes)).c_str(),
          bytesText(static_cast<double>(report.tempPeakBytes)).c_str());
  return text;
}

std::string summaryJson(const ConvertReport& report, const RunCost& cost) {
  Json stages = Json::object(), stageCpu = Json::object(), planes = Json::object();
  for (const StageTime& stage : report.stages) {
    stages[stage.name] = stage.seconds;
    stageCpu[stage.name] = stage.cpuSeconds;
  }
  for (const PlaneSize& plane : report.planes)
    planes[plane.name] = {{"raw_bytes", plane.rawBytes}, {"stored_bytes", plane.bytes}};
  const Json json{{"points", report.points},
                  {"nodes", report.nodes},
                  {"seconds", cost.seconds},
                  {"points_per_second", ratio(static_cast<double>(report.points), cost.seconds)},
                  {"cpu_seconds", cost.cpuSeconds},
                  {"peak_rss_bytes", cost.peakMemoryBytes},
                  {"input_bytes", report.inputBytes},
                  {"output_bytes", report.outputBytes},
                  {"temp_peak_bytes", report.tempPeakBytes},
                  {"skipped", report.skipped},
                  {"stages", stages},
                  {"stage_cpu_seconds", stageCpu},
                  {"nodes_by_level", report.nodesByLevel},
                  {"points_by_level", report.pointsByLevel},
                  {"planes", planes}};
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string warningJson(const std::string& message) {
  return Json{{"warning", message}}.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace strata
