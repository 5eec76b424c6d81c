#include <gtest/gtest.h>

#include <cmath>

#include "io/synthetic/random.h"
#include "io/synthetic/scanner.h"
#include "io/synthetic/scenes.h"

namespace strata::synthetic {
namespace {

constexpr std::uint64_t kPoints = 1'000'000;

/// Finds the first surface by trying every object, without the grid.
Hit bruteForce(const Scene& scene, const Ray& ray) {
  Hit hit;
  if (ray.direction.z < 0.0f) hit.t = -ray.origin.z / ray.direction.z;
  for (std::size_t i = 0; i < scene.primitives().size(); ++i)
    intersect(scene.primitives()[i], static_cast<int>(i), ray, hit);
  return hit;
}

Ray randomRay(const Scene& scene, CounterRandom& random) {
  const glm::vec2 at =
      glm::mix(scene.groundMin(), scene.groundMax(), glm::vec2(random.uniformFloat(), random.uniformFloat()));
  const glm::vec3 direction = glm::normalize(glm::vec3(random.bell(), random.bell(), random.bell() * 0.4f) + 1e-6f);
  return Ray({at.x, at.y, random.between(0.2f, scene.top() * 1.5f)}, direction, random.bits());
}

TEST(SyntheticScene, FindsThroughTheGridWhatTryingEveryObjectFinds) {
  for (const bool indoors : {false, true}) {
    const auto scan = indoors ? makeRoom(kPoints, 1) : makeCity(kPoints, 1);
    CounterRandom random(99, 0);
    int hits = 0;
    for (int i = 0; i < 6000; ++i) {
      const Ray ray = randomRay(scan->scene(), random);
      const Hit expected = bruteForce(scan->scene(), ray);
      Hit found;
      const bool any = scan->scene().trace(ray, 60.0f, found);
      const glm::vec3 at = ray.origin + ray.direction * expected.t;
      const glm::vec2 low = scan->scene().groundMin(), high = scan->scene().groundMax();
      if (!(expected.t < 60.0f) || at.x < low.x || at.y < low.y || at.x > high.x || at.y > high.y) continue;
      ASSERT_TRUE(any);
      ASSERT_NEAR(found.t, expected.t, 1e-5f * expected.t) << i;
      ++hits;
    }
    EXPECT_GT(hits, 500);
  }
}

TEST(SyntheticScene, HitsRoofsAndConesWhereTheirFormulasSay) {
  Primitive gable;
  gable.kind = PrimitiveKind::roof;
  gable.min = {0.0f, 0.0f, 5.0f};
  gable.max = {10.0f, 6.0f, 8.0f};
  gable.slope = {0.0f, 1.0f};
  Primitive spire;
  spire.kind = PrimitiveKind::cone;
  spire.min = {-2.0f, -2.0f, 0.0f};
  spire.max = {2.0f, 2.0f, 8.0f};
  spire.taper = 0.0f;
  CounterRandom random(5, 5);
  for (int i = 0; i < 2000; ++i) {
    const float x = random.between(0.1f, 9.9f), y = random.between(0.1f, 5.9f);
    Hit hit;
    ASSERT_TRUE(intersect(gable, 0, Ray({x, y, 20.0f}, {0.0f, 0.0f, -1.0f}, 0), hit));
    EXPECT_NEAR(20.0f - hit.t, 5.0f + std::min(y, 6.0f - y), 1e-4f);
    const float u = random.between(-1.9f, 1.9f), v = random.between(-1.9f, 1.9f);
    Hit coneHit;
    const bool inside = std::hypot(u, v) < 2.0f;
    ASSERT_EQ(intersect(spire, 0, Ray({u, v, 20.0f}, {0.0f, 0.0f, -1.0f}, 0), coneHit), inside);
    if (inside) {
      EXPECT_NEAR(20.0f - coneHit.t, 8.0f * (1.0f - std::hypot(u, v) / 2.0f), 1e-3f);
    }
  }
}

/// No solid object may lie between a point and its scanner. Leaves let rays through, windows lie up to 30 cm
/// behind the wall that carries them, and rounding to the grid may put a point just behind a surface that is seen at a
/// grazing angle.
void expectNothingHidden(const ScannerScan& scan, std::uint64_t step) {
  std::uint64_t hidden = 0, checked = 0;
  ShapePoint point;
  for (std::uint64_t i = 0; i < kPoints; i += step) {
    scan.generate(i, {&point, 1});
    const glm::vec3 eye = scan.stations()[scan.stationOf(i)].position;
    const glm::vec3 way = glm::vec3(point.position) - eye;
    const float distance = glm::length(way);
    const Ray ray(eye, way / distance, 0);
    Hit hit;
    for (std::size_t k = 0; k < scan.scene().primitives().size(); ++k) {
      const Primitive& p = scan.scene().primitives()[k];
      if (p.kind != PrimitiveKind::foliage) intersect(p, static_cast<int>(k), ray, hit);
    }
    const float incidence = std::max(std::abs(glm::dot(hit.normal, ray.direction)), 0.01f);
    const bool window = hit.primitive != Hit::kGround &&
                        hasWindows(scan.scene().primitives()[static_cast<std::size_t>(hit.primitive)].material);
    hidden += hit.t + 0.02f + ((window ? 0.31f : 0.0f) + 0.002f) / incidence < distance;
    ++checked;
  }
  EXPECT_EQ(hidden, 0u) << "of " << checked;
}

TEST(SyntheticCity, ShowsNoPointThatItsScannerCannotSee) { expectNothingHidden(*makeCity(kPoints, 1), 331); }
TEST(SyntheticRoom, ShowsNoPointThatItsScannerCannotSee) { expectNothingHidden(*makeRoom(kPoints, 1), 97); }

/// Rays are even in azimuth and elevation, so within the open crossing the counts in rings around a scanner must be
/// proportional to the elevations that the rings span, which is the law of Station integrated.
TEST(SyntheticCity, ThinsOutOnTheGroundAsAnEvenMirrorDoes) {
  const auto scan = makeCity(kPoints, 1);
  std::vector<ShapePoint> points(kPoints);
  scan->generate(0, points);
  std::size_t checked = 0;
  for (std::size_t s = 0; s < scan->stations().size(); ++s) {
    const Station& station = scan->stations()[s];
    if (station.solidAngle || !scan->scene().isFree({station.position.x, station.position.y, 0.5f}, 4.3f))
      continue;  // only crossings
    constexpr float kRings[6] = {1.2f, 1.6f, 2.1f, 2.7f, 3.4f, 4.2f};
    double counts[5] = {}, total = 0.0, angles = 0.0;
    for (std::uint64_t i = 0; i < kPoints; ++i) {
      if (scan->stationOf(i) != s || std::abs(points[i].position.z) > 0.02) continue;
      const float r = glm::distance(glm::vec2(points[i].position.x, points[i].position.y),
                                    glm::vec2(station.position.x, station.position.y));
      for (int ring = 0; ring < 5; ++ring) counts[ring] += r >= kRings[ring] && r < kRings[ring + 1];
    }
    double expected[5];
    for (int ring = 0; ring < 5; ++ring) {
      expected[ring] = std::atan(station.position.z / kRings[ring]) - std::atan(station.position.z / kRings[ring + 1]);
      total += counts[ring];
      angles += expected[ring];
    }
    for (int ring = 0; ring < 5; ++ring) {
      const double wanted = total * expected[ring] / angles;
      EXPECT_NEAR(counts[ring], wanted, 5.0 * std::sqrt(wanted)) << "station " << s << " ring " << ring;
    }
    ++checked;
  }
  EXPECT_GE(checked, 10u);
}

TEST(SyntheticCity, GrowsWithThePoints) {
  EXPECT_GE(makeCity(1'000'000, 1)->stations().size(), 16u);
  EXPECT_GT(makeCity(100'000'000, 1)->stations().size(), makeCity(1'000'000, 1)->stations().size());
  EXPECT_GT(makeCity(100'000'000, 1)->extent().max.x, makeCity(1'000'000, 1)->extent().max.x);
}

TEST(SyntheticRoom, HasScannersInEveryRoomUnderItsCeiling) {
  const auto scan = makeRoom(kPoints, 1);
  EXPECT_GE(scan->stations().size(), 16u);
  for (const Station& station : scan->stations()) {
    EXPECT_TRUE(scan->scene().isFree(station.position, 0.2f));
    EXPECT_TRUE(scan->scene().blocked(Ray(station.position, {0.0f, 0.0f, 1.0f}, 0), 3.0f));
  }
}

TEST(SyntheticRoom, LosesNoRayThroughItsWalls) {
  const auto scan = makeRoom(kPoints, 1);
  CounterRandom random(3, 3);
  for (int i = 0; i < 20'000; ++i) {
    const Station& station =
        scan->stations()[static_cast<std::size_t>(random.below(static_cast<int>(scan->stations().size())))];
    const glm::vec3 direction = glm::normalize(glm::vec3(random.bell(), random.bell(), random.bell()) + 1e-6f);
    Hit hit;
    ASSERT_TRUE(scan->scene().trace(Ray(station.position, direction, random.bits()), 80.0f, hit));
    const glm::dvec3 at = glm::dvec3(station.position + direction * hit.t);
    ASSERT_TRUE(glm::all(glm::lessThanEqual(scan->extent().min, at)) &&
                glm::all(glm::lessThanEqual(at, scan->extent().max)));
  }
}

}  // namespace
}  // namespace strata::synthetic
