#include <cmath>
#include <cstdio>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "viewer/measures.h"

namespace strata {
namespace {

using Json = nlohmann::json;

enum class Better { lower, higher, neither };

struct Measure {
  const char* name;
  const char* pointer;  // JSON pointer inside "measures"
  Better better;
};

// The longest frame and the points drawn are shown but not judged: one is an accident of the machine, the other
// says what was drawn, not how well.
constexpr Measure kMeasures[] = {
    {"frame_ms p50", "/frame_ms/p50", Better::lower},
    {"frame_ms p95", "/frame_ms/p95", Better::lower},
    {"frame_ms p99", "/frame_ms/p99", Better::lower},
    {"frame_ms max", "/frame_ms/max", Better::neither},
    {"points_per_second", "/points_per_second", Better::higher},
    {"points_drawn_mean", "/points_drawn_mean", Better::neither},
    {"time_to_full_detail_ms", "/time_to_full_detail_ms", Better::lower},
    {"lod_ms", "/lod_ms", Better::lower},
    {"bytes_read", "/bytes_read", Better::lower},
    {"cache_hit_rate", "/cache_hit_rate", Better::higher},
    {"hitches", "/hitches", Better::lower},
};

Json parseReport(const std::string& file, const std::string& text) {
  Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded()) throw Error(file, "is no JSON");
  if (!json.is_object() || !json.contains("measures") || !json["measures"].is_object())
    throw Error(file, "is no report of strata-bench (expected an object with measures)");
  return json;
}

double numberAt(const std::string& file, const Json& report, const Measure& measure) {
  const Json& measures = report["measures"];
  const Json::json_pointer where(measure.pointer);
  if (!measures.contains(where) || !measures[where].is_number())
    throw Error(file, std::string("measure ") + measure.name + " is missing or no number");
  return measures[where].get<double>();
}

MeasureChange change(const Measure& measure, double a, double b) {
  MeasureChange result{measure.name, a, b, 1.0, 0.0};
  if (a != b) result.ratio = a != 0.0 ? b / a : std::numeric_limits<double>::infinity();
  if (measure.better == Better::lower) result.worseBy = result.ratio - 1.0;
  if (measure.better == Better::higher) result.worseBy = b != 0.0 ? a / b - 1.0 : (a > 0.0 ? INFINITY : 0.0);
  return result;
}

std::string textOf(const Json& value) { return value.is_string() ? value.get<std::string>() : value.dump(); }

/// The members of two objects that differ, one line each.
void addDifferences(const Json& a, const Json& b, const std::string& object, const char* ignored,
                    std::vector<std::string>& out) {
  const Json empty = Json::object();
  const Json& left = a.contains(object) && a[object].is_object() ? a[object] : empty;
  const Json& right = b.contains(object) && b[object].is_object() ? b[object] : empty;
  for (const auto& [name, value] : left.items())
    if (name != ignored && right.contains(name) && right[name] != value)
      out.push_back(name + ": " + textOf(value) + " / " + textOf(right[name]));
}

}  // namespace

Comparison compareReports(const std::string& fileA, const std::string& jsonA, const std::string& fileB,
                          const std::string& jsonB) {
  const Json a = parseReport(fileA, jsonA);
  const Json b = parseReport(fileB, jsonB);
  Comparison comparison;
  for (const Measure& measure : kMeasures)
    comparison.changes.push_back(change(measure, numberAt(fileA, a, measure), numberAt(fileB, b, measure)));
  for (const char* name : {"backend", "device", "frames"})
    if (a["measures"].contains(name) && b["measures"].contains(name) && a["measures"][name] != b["measures"][name])
      comparison.differences.push_back(std::string(name) + ": " + textOf(a["measures"][name]) + " / " +
                                       textOf(b["measures"][name]));
  addDifferences(a, b, "options", "output", comparison.differences);
  addDifferences(a, b, "machine", "", comparison.differences);
  return comparison;
}

std::string comparisonTable(const Comparison& comparison, double failAbove) {
  char line[160];
  std::snprintf(line, sizeof line, "%-24s %14s %14s %8s\n", "measure", "A", "B", "B/A");
  std::string table = line;
  for (const MeasureChange& c : comparison.changes) {
    const char* verdict = c.worseBy > failAbove ? "  worse" : "";
    if (std::isfinite(c.ratio))
      std::snprintf(line, sizeof line, "%-24s %14.6g %14.6g %8.3f%s\n", c.name.c_str(), c.a, c.b, c.ratio, verdict);
    else
      std::snprintf(line, sizeof line, "%-24s %14.6g %14.6g %8s%s\n", c.name.c_str(), c.a, c.b, "-", verdict);
    table += line;
  }
  for (const std::string& difference : comparison.differences) table += "the runs differ in " + difference + "\n";
  return table;
}

bool anyWorse(const Comparison& comparison, double failAbove) {
  for (const MeasureChange& c : comparison.changes)
    if (c.worseBy > failAbove) return true;
  return false;
}

}  // namespace strata
