#include "io/synthetic/shape_source.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <map>
#include <set>
#include <tuple>

#include "core/error.h"

namespace strata {
namespace {

std::string refusal(const std::string& spec) {
  try {
    synthetic::openScan(spec);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

std::vector<glm::dvec3> positionsOf(const PointSource& source) {
  std::vector<glm::dvec3> all;
  PointBlock block;
  for (std::size_t part = 0; part < source.partCount(); ++part) {
    const auto reader = source.openPart(part);
    while (reader->read(block, 10'000)) all.insert(all.end(), block.positions.begin(), block.positions.end());
  }
  return all;
}

using Key = std::tuple<long long, long long, long long>;
Key keyOf(const glm::dvec3& p) {
  return {std::llround(p.x * 1000.0), std::llround(p.y * 1000.0), std::llround(p.z * 1000.0)};
}

TEST(SyntheticSpec, DefaultsToAMillionPoints) {
  EXPECT_EQ(synthetic::openScan("synthetic:plane")->info().pointCount, 1'000'000u);
}

TEST(SyntheticSpec, TakesCountsAsPowersOfTenUpTo1e11) {
  EXPECT_EQ(synthetic::openScan("synthetic:plane?points=1e11&seed=18446744073709551615")->info().pointCount,
            100'000'000'000u);
  EXPECT_EQ(synthetic::openScan("synthetic:stack?seed=7&points=2.5e3")->info().pointCount, 2500u);
  EXPECT_EQ(synthetic::openScan("synthetic:sphere?points=1")->info().pointCount, 1u);
}

TEST(SyntheticSpec, RefusesAnUnknownNameAndNamesTheChoices) {
  const std::string message = refusal("synthetic:castle");
  for (const char* name : {"castle", "plane", "room", "city", "terrain", "stack", "sphere", "degenerate"}) {
    EXPECT_NE(message.find(name), std::string::npos) << message;
  }
  EXPECT_NE(refusal("synthetic:").find("city"), std::string::npos);
  EXPECT_NE(refusal("city").find("synthetic:"), std::string::npos);
}

TEST(SyntheticSpec, RefusesAnUnknownKeyAndNamesTheChoices) {
  for (const char* spec :
       {"synthetic:city?colour=red", "synthetic:city?", "synthetic:city?points=1e6&", "synthetic:city?=3"}) {
    const std::string message = refusal(spec);
    EXPECT_NE(message.find("points"), std::string::npos) << spec;
    EXPECT_NE(message.find("seed"), std::string::npos) << spec;
  }
}

TEST(SyntheticSpec, RefusesValuesThatAreNoCount) {
  for (const char* value : {"", "0", "-1", "1.5", "2e11", "many", "1e6x", "nan", "inf", "0x10", " 5"}) {
    EXPECT_NE(refusal(std::string("synthetic:plane?points=") + value).find("points"), std::string::npos) << value;
  }
  for (const char* value : {"", "-1", "1.5", "1e3", "18446744073709551616", "x"}) {
    EXPECT_NE(refusal(std::string("synthetic:plane?seed=") + value).find("seed"), std::string::npos) << value;
  }
}

TEST(SyntheticSource, DescribesItself) {
  const auto source = synthetic::openScan("synthetic:city?points=2500001");
  const SourceInfo& info = source->info();
  EXPECT_EQ(info.format, "synthetic city");
  EXPECT_EQ(info.path, "synthetic:city?points=2500001");
  EXPECT_TRUE(info.boundsExact);
  EXPECT_TRUE(info.gridExact);
  EXPECT_EQ(info.step, glm::dvec3(0.001));
  EXPECT_EQ(source->partCount(), 3u);
  EXPECT_EQ(info.layout.stride(), 9u);
  EXPECT_GE(info.layout.find(attribute::kRgb), 0);
  EXPECT_GE(info.layout.find(attribute::kIntensity), 0);
  EXPECT_GE(info.layout.find(attribute::kClassification), 0);
  EXPECT_GE(synthetic::openScan("synthetic:sphere")->info().layout.find(attribute::kNormal), 0);
}

TEST(SyntheticStack, HoldsEveryGridPointOnceIn170Planes) {
  constexpr std::size_t kSide = 16;
  const auto points =
      positionsOf(*synthetic::openScan("synthetic:stack?points=" + std::to_string(170 * kSide * kSide)));
  std::set<Key> distinct;
  std::map<long long, std::size_t> layers;
  for (const glm::dvec3& p : points) {
    distinct.insert(keyOf(p));
    ++layers[std::get<1>(keyOf(p))];
  }
  EXPECT_EQ(distinct.size(), points.size());
  ASSERT_EQ(layers.size(), 170u);
  for (const auto& [y, count] : layers) EXPECT_EQ(count, kSide * kSide) << y;
}

TEST(SyntheticStack, IsShuffled) {
  const auto points = positionsOf(*synthetic::openScan("synthetic:stack?points=43520"));
  std::size_t neighbours = 0;
  for (std::size_t i = 1; i < points.size(); ++i) neighbours += glm::distance(points[i], points[i - 1]) < 0.02;
  EXPECT_LT(neighbours, points.size() / 100);
}

TEST(SyntheticSphere, LiesOnTheSphereWithItsNormals) {
  const auto source = synthetic::openScan("synthetic:sphere?points=5000");
  const PointLayout& layout = source->info().layout;
  const std::size_t offset = layout.offset(static_cast<std::size_t>(layout.find(attribute::kNormal)));
  PointBlock block;
  ASSERT_TRUE(source->openPart(0)->read(block, 5000));
  glm::dvec3 mean(0.0);
  for (std::size_t i = 0; i < block.count(); ++i) {
    glm::vec3 normal;
    std::memcpy(&normal, block.attributes.data() + i * layout.stride() + offset, sizeof normal);
    EXPECT_NEAR(glm::length(block.positions[i]), 10.0, 0.001);
    EXPECT_LT(glm::distance(glm::dvec3(normal) * 10.0, block.positions[i]), 0.001);
    mean += block.positions[i] / 5000.0;
  }
  EXPECT_LT(glm::length(mean), 0.4);
}

TEST(SyntheticDegenerate, MixesItsDistributions) {
  const auto points = positionsOf(*synthetic::openScan("synthetic:degenerate?points=100000"));
  std::map<Key, std::size_t> copies;
  std::size_t far = 0, plane = 0, cube = 0;
  for (const glm::dvec3& p : points) {
    ++copies[keyOf(p)];
    far += glm::length(p) > 1e6;
    plane += p.z == 50.0;
    cube += glm::all(glm::lessThan(glm::abs(p - glm::dvec3(70.005, 30.005, 10.005)), glm::dvec3(0.0051)));
  }
  std::size_t most = 0;
  for (const auto& [key, count] : copies) most = std::max(most, count);
  EXPECT_GE(most, 19'990u);
  EXPECT_NEAR(static_cast<double>(plane), 20'000.0, 20.0);
  EXPECT_NEAR(static_cast<double>(cube), 30'000.0, 20.0);
  EXPECT_EQ(far, 10u);
}

TEST(SyntheticTerrain, GrowsWithThePointsUpToALimit) {
  EXPECT_NEAR(synthetic::openScan("synthetic:terrain?points=1e6")->info().bounds.size().x, 1000.0, 1.0);
  EXPECT_NEAR(synthetic::openScan("synthetic:terrain?points=4e6")->info().bounds.size().y, 2000.0, 1.0);
  EXPECT_EQ(synthetic::openScan("synthetic:terrain?points=1e10")->info().bounds.size(),
            synthetic::openScan("synthetic:terrain?points=1e11")->info().bounds.size());
}

}  // namespace
}  // namespace strata
