// Estimated normals: right, and the same however the scan is cut up.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <random>

#include "converter/convert.h"
#include "converter/normals/nearest_points.h"
#include "converter/normals/normal_regions.h"
#include "converter/normals/plane_fit.h"
#include "core/octahedral.h"
#include "io/store/node_codec.h"
#include "tests/support/test_data.h"

namespace strata {
namespace {

double degreesBetween(const glm::dvec3& a, const glm::dvec3& b) {
  return glm::degrees(std::acos(std::clamp(glm::dot(glm::normalize(a), glm::normalize(b)), -1.0, 1.0)));
}

std::vector<glm::dvec3> randomPoints(std::size_t count, double size, double step) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(0.0, size);
  std::vector<glm::dvec3> points(count);
  for (glm::dvec3& p : points)
    for (int axis = 0; axis < 3; ++axis) p[axis] = std::floor(uniform(random) / step) * step;
  std::sort(points.begin(), points.end(), [](const glm::dvec3& a, const glm::dvec3& b) {
    return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
  });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

TEST(Octahedral, LosesLessThanADegreeInAnyDirection) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> bell;
  for (int i = 0; i < 30000; ++i) {
    const glm::dvec3 n(bell(random), bell(random), bell(random));
    EXPECT_LT(degreesBetween(n, glm::dvec3(decodeOctahedral(encodeOctahedral(n)))), 1.0);
  }
}

TEST(Octahedral, KeepsTheAxesExactly) {
  for (int axis = 0; axis < 3; ++axis)
    for (const float sign : {-1.0f, 1.0f}) {
      glm::vec3 n(0.0f);
      n[axis] = sign;
      EXPECT_EQ(decodeOctahedral(encodeOctahedral(glm::dvec3(n))), n);
    }
}

TEST(NearestPoints, FindsWhatLookingAtEveryPointFinds) {
  // On a coarse grid, so that many points are equally far.
  const std::vector<glm::dvec3> points = randomPoints(3000, 10.0, 0.5);
  const NearestPoints tree(points);
  std::vector<std::uint32_t> found;
  for (std::uint32_t from = 0; from < points.size(); from += 7)
    for (const double reach : {0.4, 1.1, 3.0, 100.0}) {
      std::vector<std::pair<double, std::uint32_t>> all;
      for (std::uint32_t i = 0; i < points.size(); ++i) {
        const double square = glm::dot(points[i] - points[from], points[i] - points[from]);
        if (square <= reach * reach) all.emplace_back(square, i);
      }
      std::sort(all.begin(), all.end());
      all.resize(std::min<std::size_t>(all.size(), 16));
      tree.find(from, 16, reach, found);
      ASSERT_EQ(found.size(), all.size());
      for (std::size_t i = 0; i < all.size(); ++i) ASSERT_EQ(found[i], all[i].second);
    }
}

TEST(PlaneNormal, IsOpenForFewPointsAndForLines) {
  EXPECT_FALSE(planeNormal(std::vector<glm::dvec3>{{0, 0, 0}, {1, 0, 0}}));
  EXPECT_FALSE(planeNormal(std::vector<glm::dvec3>{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {5, 5, 5}}));
  EXPECT_FALSE(planeNormal(std::vector<glm::dvec3>(5, {3, 3, 3})));
  const auto normal = planeNormal(std::vector<glm::dvec3>{{0, 0, 7}, {1, 0, 7}, {0, 1, 7}, {1, 1, 7}});
  ASSERT_TRUE(normal);
  EXPECT_NEAR(std::abs(normal->z), 1.0, 1e-12);
}

/// Grid integers of every point with its normal's bytes; equal points have equal normals.
std::map<std::array<std::int64_t, 3>, Octahedral> normalsOf(const Store& store) {
  std::map<std::array<std::int64_t, 3>, Octahedral> all;
  const int index = store.info().layout.find(attribute::kNormalOctahedral);
  EXPECT_GE(index, 0);
  const std::size_t offset = store.info().layout.offset(static_cast<std::size_t>(index));
  for (std::uint32_t n = 0; n < store.hierarchy().nodes.size(); ++n) {
    const NodePoints points = readAll(store, n);
    for (std::size_t i = 0; i < points.count(); ++i) {
      Octahedral code;
      std::memcpy(code.data(), points.attributes.data() + i * store.info().layout.stride() + offset, sizeof code);
      const auto [at, added] = all.insert({{points.grid[0][i], points.grid[1][i], points.grid[2][i]}, code});
      EXPECT_EQ(at->second, code);
    }
  }
  return all;
}

void convertWithNormals(const std::filesystem::path& store, const std::string& input,
                        std::uint64_t memory = kLeastMemoryBytes, int threads = 2, std::uint32_t nodePoints = 4096) {
  ConvertOptions options;
  options.inputs = {input};
  options.output = store.string();
  options.threads = threads;
  options.nodePoints = nodePoints;
  options.memoryBytes = memory;
  options.normals = true;
  convert(options, ConvertControl{});
}

glm::dvec3 worldOf(const Store& store, const std::array<std::int64_t, 3>& grid) {
  return store.info().grid.offset + store.info().grid.scale * glm::dvec3(grid[0], grid[1], grid[2]);
}

TEST(Normals, StandAcrossTheirSurfaceAndLookUp) {
  const test::TempFolder folder;
  // Points on a paraboloid, as text, so that there are no normals of its own.
  {
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> uniform(-10.0, 10.0);
    std::ofstream out(folder / "dish.xyz");
    out.precision(9);
    for (int i = 0; i < 60000; ++i) {
      const double x = uniform(random), y = uniform(random);
      out << std::fixed << x << ' ' << y << ' ' << 0.05 * (x * x + y * y) << '\n';
    }
  }
  convertWithNormals(folder / "dish.strata", (folder / "dish.xyz").string());
  const Store store((folder / "dish.strata").string());
  double worst = 0.0, sum = 0.0;
  const auto normals = normalsOf(store);
  for (const auto& [grid, code] : normals) {
    const glm::dvec3 p = worldOf(store, grid), expected(-0.1 * p.x, -0.1 * p.y, 1.0);
    const double off = degreesBetween(expected, glm::dvec3(decodeOctahedral(code)));
    worst = std::max(worst, off);
    sum += off;
  }
  EXPECT_LT(worst, 5.0);
  EXPECT_LT(sum / static_cast<double>(normals.size()), 1.0);
}

TEST(Normals, AreTheSameBytesForAnyMemoryThreadsAndNodeSize) {
  const test::TempFolder folder;
  const std::string input = "synthetic:city?points=400000&seed=4";
  convertWithNormals(folder / "a", input);
  convertWithNormals(folder / "b", input, std::uint64_t{4} << 30, 1, 65536);
  const auto a = normalsOf(Store((folder / "a").string())), b = normalsOf(Store((folder / "b").string()));
  EXPECT_EQ(a.size(), b.size());
  EXPECT_TRUE(a == b);
}

TEST(Normals, DoNotDependOnHowTheScanIsCutIntoRegions) {
  const test::TempFolder folder;
  convertWithNormals(folder / "a", "synthetic:terrain?points=120000&seed=4");
  const Store store((folder / "a").string());
  ConvertOptions options;
  options.threads = 2;
  const double reach = neighbourReach(store, options, ConvertControl{});
  std::map<std::pair<std::uint32_t, std::uint32_t>, Octahedral> whole, parts;
  const auto estimate = [&](std::uint64_t limit, auto& out) {
    const std::vector<NormalRegion> regions = normalRegions(store.hierarchy(), limit);
    for (const NormalRegion& region : regions) {
      const RegionNormals one = estimateRegion(store, region, reach, 1u << 30, std::nullopt);
      for (std::size_t i = 0; i < one.points.size(); ++i)
        EXPECT_TRUE(out.insert({{one.points[i].node, one.points[i].point}, one.normals[i]}).second);
    }
    return regions.size();
  };
  EXPECT_EQ(estimate(1u << 30, whole), 1u);
  EXPECT_GT(estimate(8000, parts), 20u);
  EXPECT_EQ(whole.size(), store.info().points);
  EXPECT_TRUE(whole == parts);
}

TEST(Normals, OfAScanThatHasThemStayAsTheyAre) {
  const test::TempFolder folder;
  convertWithNormals(folder / "a", "synthetic:sphere?points=20000");
  const Store store((folder / "a").string());
  EXPECT_GE(store.info().layout.find(attribute::kNormal), 0);
  EXPECT_LT(store.info().layout.find(attribute::kNormalOctahedral), 0);
}

TEST(Normals, LookTowardsTheScannerWhereItIsKnown) {
  const test::TempFolder folder;
  {
    std::ofstream out(folder / "ceiling.pcd");
    out << "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 10000\nHEIGHT 1\n"
           "VIEWPOINT 5 5 1.5 1 0 0 0\nPOINTS 10000\nDATA ascii\n";
    for (int i = 0; i < 10000; ++i) out << 0.1 * (i % 100) << ' ' << 0.1 * (i / 100) << " 3\n";
  }
  convertWithNormals(folder / "a", (folder / "ceiling.pcd").string());
  for (const auto& [grid, code] : normalsOf(Store((folder / "a").string()))) {
    EXPECT_LT(degreesBetween({0.0, 0.0, -1.0}, glm::dvec3(decodeOctahedral(code))), 1.0);
  }
}

}  // namespace
}  // namespace strata
