#include "viewer/tools/measurement.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/error.h"

namespace strata {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostVertices = 10000;
constexpr const char* kNames[] = {"point", "distance", "height", "angle", "area", "polyline", "profile"};
constexpr double kDegree = std::numbers::pi / 180.0;

std::string number(double value, const char* format) {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

/// Twice the polygon's area, along its normal. Relative to the first point: coordinates are large, areas small.
glm::dvec3 newellNormal(const std::vector<glm::dvec3>& points) {
  glm::dvec3 sum(0.0);
  for (std::size_t i = 1; i + 1 < points.size(); ++i)
    sum += glm::cross(points[i] - points[0], points[i + 1] - points[0]);
  return sum;
}

struct Value {
  double value = 0.0;
  const char* unit = "";
};

Value valueOf(const Measurement& m) {
  switch (m.kind) {
    case MeasureKind::point:
      return {m.points[0].z, "m"};
    case MeasureKind::distance:
    case MeasureKind::polyline:
    case MeasureKind::profile:
      return {lengthOf(m.points), "m"};
    case MeasureKind::height:
      return {heightOf(m.points), "m"};
    case MeasureKind::angle:
      return {angleOf(m.points) / kDegree, "degrees"};
    case MeasureKind::area:
      return {areaOf(m.points), "m2"};
  }
  return {};
}

std::string csvField(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted.push_back('"');
    quoted.push_back(c);
  }
  quoted.push_back('"');
  return quoted;
}

constexpr double kProfileShare = 0.02;  // of its length, the width of a new profile

bool isWhole(const Measurement& m) { return m.points.size() >= leastPoints(m.kind); }

}  // namespace

const char* measureName(MeasureKind kind) { return kNames[static_cast<std::size_t>(kind)]; }

MeasureKind parseMeasure(const std::string& name) {
  for (std::size_t i = 0; i < std::size(kNames); ++i)
    if (name == kNames[i]) return static_cast<MeasureKind>(i);
  throw UsageError("found measurement '" + name +
                   "' (expected point, distance, height, angle, area, polyline or profile)");
}

std::size_t leastPoints(MeasureKind kind) {
  if (kind == MeasureKind::point) return 1;
  return kind == MeasureKind::angle || kind == MeasureKind::area ? 3 : 2;
}

std::size_t mostPoints(MeasureKind kind) { return isOpenEnded(kind) ? kMostVertices : leastPoints(kind); }

bool isOpenEnded(MeasureKind kind) {
  return kind == MeasureKind::area || kind == MeasureKind::polyline || kind == MeasureKind::profile;
}

double lengthOf(const std::vector<glm::dvec3>& points) {
  double length = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) length += glm::distance(points[i - 1], points[i]);
  return length;
}

double heightOf(const std::vector<glm::dvec3>& points) {
  if (points.empty()) return 0.0;
  const auto [low, high] = std::minmax_element(points.begin(), points.end(),
                                               [](const glm::dvec3& a, const glm::dvec3& b) { return a.z < b.z; });
  return high->z - low->z;
}

double profileWidth(const std::vector<glm::dvec3>& points) { return niceStep(kProfileShare * lengthOf(points)); }

double angleOf(const std::vector<glm::dvec3>& points) {
  if (points.size() < 3) return 0.0;
  const glm::dvec3 a = points[0] - points[1];
  const glm::dvec3 b = points[2] - points[1];
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

double areaOf(const std::vector<glm::dvec3>& points) { return 0.5 * glm::length(newellNormal(points)); }

double groundAreaOf(const std::vector<glm::dvec3>& points) { return 0.5 * std::abs(newellNormal(points).z); }

double niceStep(double least) {
  if (!(least > 0.0) || !std::isfinite(least)) return 1.0;
  const double power = std::pow(10.0, std::floor(std::log10(least)));
  for (const double step : {1.0, 2.0, 5.0})
    if (step * power >= least) return step * power;
  return 10.0 * power;
}

std::string measureText(const Measurement& m) {
  if (!isWhole(m)) return {};
  switch (m.kind) {
    case MeasureKind::point:
      return number(m.points[0].x, "%.3f ") + number(m.points[0].y, "%.3f ") + number(m.points[0].z, "%.3f");
    case MeasureKind::distance:
    case MeasureKind::polyline:
      return number(lengthOf(m.points), "%.3f m");
    case MeasureKind::profile:
      return number(lengthOf(m.points), "%.3f m, ") + number(m.width, "%.3g m wide");
    case MeasureKind::height:
      return number(heightOf(m.points), "%.3f m over ") +
             number(glm::length(glm::dvec2(m.points[1] - m.points[0])), "%.3f m");
    case MeasureKind::angle:
      return number(angleOf(m.points) / kDegree, "%.2f°");
    case MeasureKind::area:
      return number(areaOf(m.points), "%.3f m² (ground ") + number(groundAreaOf(m.points), "%.3f m²)");
  }
  return {};
}

std::string measurementsCsv(const std::vector<Measurement>& measurements) {
  std::string csv = "name,kind,value,unit,points\n";
  for (const Measurement& m : measurements) {
    if (!isWhole(m)) continue;
    const Value value = valueOf(m);
    csv += csvField(m.name) + "," + measureName(m.kind) + "," + number(value.value, "%.6f") + "," + value.unit + ",";
    for (std::size_t i = 0; i < m.points.size(); ++i)
      csv += number(m.points[i].x, i == 0 ? "%.6f" : "; %.6f") + number(m.points[i].y, " %.6f") +
             number(m.points[i].z, " %.6f");
    csv.push_back('\n');
  }
  return csv;
}

std::string measurementsGeoJson(const std::vector<Measurement>& measurements, const std::string& crs) {
  Json features = Json::array();
  for (const Measurement& m : measurements) {
    if (!isWhole(m)) continue;
    Json line = Json::array();
    for (const glm::dvec3& p : m.points) line.push_back({p.x, p.y, p.z});
    Json geometry;
    if (m.kind == MeasureKind::point) {
      geometry = {{"type", "Point"}, {"coordinates", line[0]}};
    } else if (m.kind == MeasureKind::area) {
      line.push_back(line[0]);
      geometry = {{"type", "Polygon"}, {"coordinates", Json::array({line})}};
    } else {
      geometry = {{"type", "LineString"}, {"coordinates", line}};
    }
    const Value value = valueOf(m);
    Json properties{{"name", m.name}, {"kind", measureName(m.kind)}, {"value", value.value}, {"unit", value.unit}};
    if (m.kind == MeasureKind::profile) properties["width"] = m.width;
    features.push_back({{"type", "Feature"}, {"properties", properties}, {"geometry", geometry}});
  }
  Json collection{{"type", "FeatureCollection"}};
  if (!crs.empty()) collection["coordinate_system"] = crs;
  collection["features"] = std::move(features);
  return collection.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace strata
