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
/// Takes points until the user says that it is done.
bool isOpenEnded(MeasureKind kind);

/// Length of the polyline through the points.
double lengthOf(const std::vector<glm::dvec3>& points);
/// From the lowest to the highest point.
double heightOf(const std::vector<glm::dvec3>& points);
/// At the second of three points, radians, 0 to pi.
double angleOf(const std::vector<glm::dvec3>& points);
/// Of the closed polygon: of its projection to the plane that shows it largest (Newell's normal), exact where it is
/// flat.
double areaOf(const std::vector<glm::dvec3>& points);
/// Of its projection to the ground.
double groundAreaOf(const std::vector<glm::dvec3>& points);

/// How wide a new profile along these points is: a fiftieth of its length, as a round number.
double profileWidth(const std::vector<glm::dvec3>& points);
/// 1, 2 or 5 times a power of ten: the least such that is at least `least`; 1 where that is no positive number.
double niceStep(double least);

/// What is shown beside it: "12.345 m", "1.20 m over 3.40 m", "90.00°", "25.00 m² (ground 24.10 m²)". Empty while
/// points are missing.
std::string measureText(const Measurement& measurement);

/// One line a measurement: name, kind, value, unit, then x y z of each point.
std::string measurementsCsv(const std::vector<Measurement>& measurements);
/// RFC 7946's structure, in the coordinates of the scan; `crs` (EPSG:n or WKT, may be empty) is named beside it.
std::string measurementsGeoJson(const std::vector<Measurement>& measurements, const std::string& crs);

}  // namespace strata
