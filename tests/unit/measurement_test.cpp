#include "viewer/tools/measurement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <glm/gtc/quaternion.hpp>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>

#include "core/error.h"

namespace strata {
namespace {

const glm::dvec3 kUtm(630000.0, 4850000.0, 120.0);

/// Any rotation and a shift as large as map coordinates are.
std::vector<glm::dvec3> moved(std::vector<glm::dvec3> points, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> any;
  const glm::dquat turn = glm::normalize(glm::dquat(any(random), any(random), any(random), any(random)));
  for (glm::dvec3& p : points) p = kUtm + turn * p;
  return points;
}

TEST(Measurement, LengthAngleAndAreaDoNotDependOnWhereAndHowTheThingStands) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    EXPECT_NEAR(lengthOf(moved({{0, 0, 0}, {3, 4, 0}, {3, 4, 12}}, seed)), 17.0, 1e-6);
    EXPECT_NEAR(angleOf(moved({{5, 0, 0}, {0, 0, 0}, {2, 2, 0}}, seed)), std::numbers::pi / 4, 1e-8);
    EXPECT_NEAR(areaOf(moved({{0, 0, 0}, {4, 0, 0}, {4, 3, 0}, {0, 3, 0}}, seed)), 12.0, 1e-6);
    // An L: concave.
    EXPECT_NEAR(areaOf(moved({{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}}, seed)), 3.0, 1e-6);
  }
}

TEST(Measurement, GroundAreaIsTheAreaSeenFromAbove) {
  const std::vector<glm::dvec3> roof{kUtm, kUtm + glm::dvec3(4, 0, 0), kUtm + glm::dvec3(4, 3, 3),
                                     kUtm + glm::dvec3(0, 3, 3)};
  EXPECT_NEAR(areaOf(roof), 4.0 * 3.0 * std::numbers::sqrt2, 1e-7);
  EXPECT_NEAR(groundAreaOf(roof), 12.0, 1e-7);
}

TEST(Measurement, HeightIsFromTheLowestToTheHighest) {
  EXPECT_NEAR(heightOf({{0, 0, 5}, {9, 9, 2.5}}), 2.5, 1e-12);
  EXPECT_EQ(heightOf({}), 0.0);
}

TEST(Measurement, TextIsEmptyUntilThereAreEnoughPoints) {
  for (const MeasureKind kind : kMeasureKinds) {
    Measurement m{"m", kind, {}, true, 1.0};
    while (m.points.size() < leastPoints(kind)) {
      EXPECT_EQ(measureText(m), "");
      m.points.push_back({static_cast<double>(m.points.size()), 1.0, 2.0});
    }
    EXPECT_NE(measureText(m), "") << measureName(kind);
    EXPECT_EQ(parseMeasure(measureName(kind)), kind);
  }
  EXPECT_THROW(parseMeasure("volume"), UsageError);
}

TEST(Measurement, CsvQuotesNamesAndKeepsMillimetresOfMapCoordinates) {
  const std::string csv =
      measurementsCsv({{"a \"b\", c", MeasureKind::distance, {kUtm, kUtm + glm::dvec3(0, 0, 0.001)}}});
  EXPECT_NE(csv.find("\"a \"\"b\"\", c\",distance,0.001000,m,630000.000000 4850000.000000 120.000000; "),
            std::string::npos)
      << csv;
}

TEST(Measurement, GeoJsonHasAGeometryForEachKindAndClosesPolygons) {
  std::vector<Measurement> all{{"p", MeasureKind::point, {kUtm}},
                               {"d", MeasureKind::distance, {kUtm, kUtm + 1.0}},
                               {"a", MeasureKind::area, {kUtm, kUtm + glm::dvec3(1, 0, 0), kUtm + glm::dvec3(0, 1, 0)}},
                               {"unfinished", MeasureKind::angle, {kUtm}}};
  const nlohmann::json json = nlohmann::json::parse(measurementsGeoJson(all, "EPSG:25832"));
  ASSERT_EQ(json["features"].size(), 3u);
  EXPECT_EQ(json["coordinate_system"], "EPSG:25832");
  EXPECT_EQ(json["features"][0]["geometry"]["type"], "Point");
  EXPECT_EQ(json["features"][1]["geometry"]["coordinates"].size(), 2u);
  const auto& ring = json["features"][2]["geometry"]["coordinates"][0];
  ASSERT_EQ(ring.size(), 4u);
  EXPECT_EQ(ring[0], ring[3]);
  EXPECT_NEAR(json["features"][2]["properties"]["value"].get<double>(), 0.5, 1e-6);
}

TEST(Measurement, ScalesHaveRoundSteps) {
  EXPECT_DOUBLE_EQ(niceStep(0.3), 0.5);
  EXPECT_DOUBLE_EQ(niceStep(1.0), 1.0);
  EXPECT_DOUBLE_EQ(niceStep(70.0), 100.0);
  EXPECT_DOUBLE_EQ(niceStep(0.0), 1.0);
}

}  // namespace
}  // namespace strata
