#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "render/cpu/cpu_rasterizer.h"
#include "render/plan/batch_plan.h"
#include "tests/support/oracle.h"
#include "tests/support/synthetic_nodes.h"

namespace strata {
namespace {

constexpr double kAgreement = 0.999;
const glm::dvec3 kUtm(456789.123, 5412345.678, 312.5);
/// Has none of the symmetries of a grid. With them many points would have the same depth, and rounding would decide.
const glm::dvec3 kDirection(1.0, 0.83, -0.71);

Picture drawn(const RenderList& list, const View& view, int threads = 1, const DrawOptions& options = {}) {
  RasterizerOptions rasterizerOptions;
  rasterizerOptions.threads = threads;
  Picture picture;
  createCpuRasterizer(rasterizerOptions)->draw(list, view, options, picture);
  return picture;
}

void expectOraclesPicture(const RenderList& list, const View& view) {
  const test::Comparison result = test::compareToOracle(list, view, drawn(list, view));
  EXPECT_GE(result.agreement(), kAgreement) << result.different << " of " << result.covered << " pixels differ";
  EXPECT_EQ(result.unexplained, 0u) << result.firstUnexplained;
}

RenderList cutToHalf(RenderList list) {
  list.pointCount = 0;
  for (RenderItem& item : list.items) {
    item.pointCount = item.pointCount / 2 + 1;
    list.pointCount += item.pointCount;
  }
  return list;
}

std::vector<glm::dvec3> randomPoints(std::uint32_t count, const glm::dvec3& lo, const glm::dvec3& size,
                                     std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<glm::dvec3> points(count);
  for (glm::dvec3& p : points) p = lo + size * glm::dvec3(unit(random), unit(random), unit(random));
  return points;
}

double coveredPart(const Picture& picture) {
  std::size_t covered = 0;
  for (const std::uint32_t id : picture.pointId) covered += id != Picture::kNoPoint;
  return static_cast<double>(covered) / static_cast<double>(picture.pointId.size());
}

TEST(CpuRasterizer, GivesTheOraclesPictureOfATownFromAllSides) {
  const RenderList list = test::makeTown(glm::dvec3(0.0), 200.0, 200000, 1);
  for (const View& view : test::viewsAround(test::boundsOf(list), 20, 512, 512)) expectOraclesPicture(list, view);
}

TEST(CpuRasterizer, GivesTheOraclesPictureAtUtmCoordinates) {
  const RenderList list = test::makeTown(kUtm, 200.0, 200000, 2);
  for (const View& view : test::viewsAround(test::boundsOf(list), 12, 512, 512)) expectOraclesPicture(list, view);
}

TEST(CpuRasterizer, GivesTheOraclesPictureAtFullHighDefinition) {
  const RenderList list = test::makeTown(kUtm, 500.0, 1000000, 3);
  for (const View& view : test::viewsAround(test::boundsOf(list), 3, 1920, 1080)) expectOraclesPicture(list, view);
}

TEST(CpuRasterizer, DrawsOnlyThePrefixOfEachNode) {
  const RenderList list = cutToHalf(test::makeTown(kUtm, 200.0, 100000, 4));
  for (const View& view : test::viewsAround(test::boundsOf(list), 10, 512, 512)) expectOraclesPicture(list, view);
}

TEST(CpuRasterizer, GivesTheOraclesPictureOfCubesOfEverySize) {
  for (const double side : {0.01, 1.0, 1000.0, 100000.0}) {
    const RenderList list =
        test::makeList({test::makeNode({}, randomPoints(50000, kUtm, glm::dvec3(side), 5), side * 1e-8, 3000),
                        test::makeNode(NodeKey{}.child(3),
                                       randomPoints(50000, kUtm, side * glm::dvec3(2.0, 1e-3, 1.0), 6), side * 1e-4)});
    for (const View& view : test::viewsAround(test::boundsOf(list), 12, 512, 512)) expectOraclesPicture(list, view);
  }
}

TEST(CpuRasterizer, GivesTheSameBitsWithOneAndTwoThreads) {
  const RenderList list = test::makeTown(kUtm, 100.0, 300000, 7);
  DrawOptions options;
  options.pointSize = 2;
  options.edl = true;
  for (const View& view : test::viewsAround(test::boundsOf(list), 8, 512, 512)) {
    const Picture one = drawn(list, view, 1, options), two = drawn(list, view, 2, options),
                  again = drawn(list, view, 2, options);
    EXPECT_EQ(one.pointId, two.pointId);
    EXPECT_EQ(one.depth, two.depth);
    EXPECT_EQ(one.colour, two.colour);
    EXPECT_EQ(two.colour, again.colour);
  }
}

TEST(CpuRasterizer, GivesATieToTheLowerId) {
  const std::vector<glm::dvec3> same(20000, glm::dvec3(0.0, 5.0, 0.0));
  const RenderList list = test::makeList({test::makeNode({}, same, 0.001), test::makeNode({}, same, 0.001)});
  View view;
  view.eye = {0.0, 0.0, 0.0};
  view.target = {0.0, 5.0, 0.0};
  const Picture picture = drawn(list, view, 2);
  std::size_t covered = 0;
  for (const std::uint32_t id : picture.pointId) {
    if (id == Picture::kNoPoint) continue;
    ++covered;
    EXPECT_EQ(id, 0u);
  }
  EXPECT_EQ(covered, 1u);
}

TEST(CpuRasterizer, MatchesAtTheOriginAndAtUtmCoordinates) {
  const std::vector<glm::dvec3> local = randomPoints(300000, glm::dvec3(-2.0), glm::dvec3(4.0), 8);
  const glm::dvec3 far(400000.0, 5400000.0, 128.0);
  std::vector<glm::dvec3> moved = local;
  for (glm::dvec3& p : moved) p += far;
  const double step = 1.0 / 1024.0;  // keeps `far` on the grid, so that both nodes hold the same integers
  const RenderList here = test::makeList({test::makeNode({}, local, step)});
  const RenderList there = test::makeList({test::makeNode({}, moved, step)});
  for (int centimetres = 0; centimetres < 10; ++centimetres) {
    View view;
    view.width = view.height = 512;
    view.eye = {0.01 * centimetres, -3.0, 0.5};
    view.target = {0.01 * centimetres, 0.0, 0.0};
    const Picture a = drawn(here, view);
    view.eye += far;
    view.target += far;
    const Picture b = drawn(there, view);
    std::size_t covered = 0, different = 0;
    for (std::size_t i = 0; i < a.pointId.size(); ++i) {
      covered += a.pointId[i] != Picture::kNoPoint;
      different += a.pointId[i] != b.pointId[i];
    }
    EXPECT_GT(covered, a.pointId.size() / 4);
    EXPECT_LE(static_cast<double>(different), 0.001 * static_cast<double>(covered));
  }
}

TEST(CpuRasterizer, DrawsNothingOfNothing) {
  View view;
  view.width = view.height = 64;
  EXPECT_EQ(coveredPart(drawn({}, view)), 0.0);
  RenderList list = test::makeTown(glm::dvec3(0.0), 10.0, 1000, 9);
  for (RenderItem& item : list.items) item.pointCount = 0;
  list.pointCount = 0;
  EXPECT_EQ(coveredPart(drawn(list, view)), 0.0);
  view.width = 0;
  EXPECT_TRUE(drawn(list, view).colour.empty());
}

TEST(CpuRasterizer, DrawsABatchOfOnePointAsOnePixel) {
  const RenderList list = test::makeList({test::makeNode({}, {kUtm}, 0.001)});
  const View view = viewOfBox({kUtm - 1.0, kUtm + 1.0}, kDirection, 301, 201, 1.0);
  const Picture picture = drawn(list, view);
  EXPECT_EQ(std::count(picture.pointId.begin(), picture.pointId.end(), 0u), 1);
  expectOraclesPicture(list, view);
}

TEST(CpuRasterizer, LeavesOutWhatIsBehindTheEyeOrNearerThanTheNearPlane) {
  const RenderList list = test::makeList({test::makeNode({}, randomPoints(100000, {-1, -1, -1}, {2, 2, 2}, 10), 1e-4)});
  View view;
  view.width = view.height = 256;
  view.eye = {0.0, 0.0, 0.0};
  view.target = {0.3, 1.0, 0.1};
  for (const double nearPlane : {1e-3, 0.5, 0.9}) {
    view.nearPlane = nearPlane;
    const Picture picture = drawn(list, view);
    for (const float depth : picture.depth) EXPECT_GE(depth, static_cast<float>(nearPlane));
    expectOraclesPicture(list, view);
  }
}

TEST(CpuRasterizer, DrawsHugeCoordinatesFromClose) {
  const glm::dvec3 far(1e7, -1e7, 1e7);
  const RenderList list =
      test::makeList({test::makeNode({}, randomPoints(200000, far, glm::dvec3(1.0), 11), 1e-5),
                      test::makeNode({}, randomPoints(200000, far - 5e4, glm::dvec3(1e5), 12), 1e-3)});
  for (int i = 0; i < 8; ++i) {
    View view;
    view.width = view.height = 512;
    view.eye = far + glm::dvec3(0.5, -0.2 - 0.1 * i, 0.5);
    view.target = far + 0.5;
    expectOraclesPicture(list, view);
  }
}

TEST(CpuRasterizer, DrawsImagesOfOnePixelAndOf8192Squared) {
  const RenderList list = test::makeTown(kUtm, 100.0, 100000, 13);
  View view = viewOfBox(test::boundsOf(list), kDirection, 1, 1, 1.0);
  EXPECT_EQ(drawn(list, view).colour.size(), 1u);
  view.width = view.height = 8192;
  const Picture picture = drawn(list, view, 2);
  EXPECT_EQ(picture.colour.size(), std::size_t{8192} * 8192);
  EXPECT_GT(coveredPart(picture), 1e-3);
}

TEST(CpuRasterizer, RefusesToDrawAViewThatIsNotFinite) {
  const RenderList list = test::makeTown(kUtm, 100.0, 1000, 14);
  View view = viewOfBox(test::boundsOf(list), kDirection, 64, 64, 1.0);
  view.eye.x = std::nan("");
  EXPECT_EQ(coveredPart(drawn(list, view)), 0.0);
}

TEST(CpuRasterizer, CountsWhatItDrewAndCulled) {
  const RenderList list = test::makeTown(glm::dvec3(0.0), 100.0, 100000, 15);
  std::uint32_t batches = 0;
  for (const RenderItem& item : list.items) batches += static_cast<std::uint32_t>(item.node->batches.size());
  Picture picture;
  const auto rasterizer = createCpuRasterizer({});
  for (const View& view : test::viewsAround(test::boundsOf(list), 8, 256, 256)) {
    const DrawStats stats = rasterizer->draw(list, view, {}, picture);
    EXPECT_EQ(stats.batchesDrawn + stats.batchesCulled, batches);
    EXPECT_EQ(stats.batchesAt[0] + stats.batchesAt[1] + stats.batchesAt[2], stats.batchesDrawn);
    EXPECT_LE(stats.pointsDrawn, list.pointCount);
  }
}

}  // namespace
}  // namespace strata
