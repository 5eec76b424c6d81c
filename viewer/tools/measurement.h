#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <glm/glm.hpp>

namespace strata {

enum class MeasureKind : std::uint8_t { point, distance, height, angle, area, polyline, profile };
inline constexpr std::array kMeasureKinds{MeasureKind::point,  MeasureKind::distance, MeasureKind::polyline,
                                          MeasureKind::height, MeasureKind::angle,    MeasureKind::area,
                                          MeasureKind::profile};

/// Something measured on the points of a scan. World coordinates, metres.
struct Measurement {
  std::string name;
  MeasureKind kind = MeasureKind::distance;
  std::vector<glm::dvec3> points;
  bool visible = true;
  double width = 1.0;  ///< of a profile's slab

  bool operator==(const Measurement&) const = default;
};

/// "point", "distance", "height", "angle", "area", "polyline", "profile"; parse throws UsageError for another name.
const char* measureName(MeasureKind kind);
MeasureKind parseMeasure(const std::string& name);

/// How many points a measurement needs to mean something, and can have at most.
std::size_t leastPoints(MeasureKind kind);
std::size_t mostPoints(MeasureKind kind);
/// True for a kind that takes points until the user says that it is complete.
bool isOpenEnded(MeasureKind kind);

/// The length of the polyline through the points.
double lengthOf(const std::vector<glm::dvec3>& points);
/// The difference in height between the lowest and the highest point.
double heightOf(const std::vector<glm::dvec3>& points);
/// The angle at the second of three points, 0 to pi, in radians.
double angleOf(const std::vector<glm::dvec3>& points);
/// The area of the closed polygon's projection to the plane that shows it largest (Newell's normal). For a flat polygon
/// this is its exact area.
double areaOf(const std::vector<glm::dvec3>& points);
/// The area of the polygon's projection to the ground.
double groundAreaOf(const std::vector<glm::dvec3>& points);

/// The width of a new profile along these points: a fiftieth of its length, as a round number.
double profileWidth(const std::vector<glm::dvec3>& points);
/// The smallest of 1, 2 and 5 times a power of ten that is at least `least`; 1 when `least` is no positive number.
double niceStep(double least);

/// The text that is shown beside a measurement: "12.345 m", "1.20 m over 3.40 m", "90.00°", "25.00 m² (ground 24.10
/// m²)". Empty while points are missing.
std::string measureText(const Measurement& measurement);

/// One line for each measurement: name, kind, value, unit, then x y z of each point.
std::string measurementsCsv(const std::vector<Measurement>& measurements);
/// RFC 7946's structure, in the coordinates of the scan; `crs` (EPSG:n or WKT, may be empty) is named beside it.
std::string measurementsGeoJson(const std::vector<Measurement>& measurements, const std::string& crs);

}  // namespace strata
