// Scans whose points are spread so unevenly that converters break: every point comes back, under the memory cap.
#include <functional>
#include <random>

#include "tests/support/programs.h"

namespace strata::test {
namespace {

namespace fs = std::filesystem;

constexpr int kPoints = 1'100'000;  // more than twice what one chunk holds at 512M

using Triple = std::array<std::int32_t, 3>;

/// Converts with --memory 512M and expects every record back, in any order, within the memory and within a temporary
/// file of at most `tempShare` times the size of the input.
void expectComesBack(const LasSpec& spec, double tempShare = 1.0) {
  const TempFolder folder;
  writeLas(folder / "scan.las", spec);
  const Json result = mustConvert({(folder / "scan.las").string()}, folder / "a.strata", {"--memory", "512M"});
  EXPECT_EQ(result.at("points"), spec.points.size());
  EXPECT_LE(result.at("peak_rss_bytes").get<std::uint64_t>(), std::uint64_t{512} << 20);
  EXPECT_LE(result.at("temp_peak_bytes").get<double>(),
            tempShare * static_cast<double>(fs::file_size(folder / "scan.las")));
  EXPECT_EQ(mustInfo(folder / "a.strata", true).at("bad_nodes"), 0);
  const LasFile back = mustExport(folder / "a.strata", folder / "back.las"), scan = readLas(folder / "scan.las");
  ASSERT_EQ(back.count, scan.count);
  EXPECT_TRUE(back.sortedRecords() == scan.sortedRecords());
}

LasSpec scanOf(const std::function<Triple(int, std::mt19937&)>& point, int count = kPoints) {
  LasSpec spec;
  std::mt19937 random(3);
  spec.points.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) spec.points.push_back(point(i, random));
  return spec;
}

std::int32_t upTo(std::mt19937& random, std::int32_t end) {
  return std::uniform_int_distribution<std::int32_t>(0, end - 1)(random);
}

TEST(Limits, NineTenthsOfThePointsInATenThousandthOfTheVolume) {
  constexpr std::int32_t kSide = 2'000'000, kDense = 92'800;  // (kDense / kSide) cubed is a ten-thousandth
  expectComesBack(scanOf([](int i, std::mt19937& random) {
    const std::int32_t side = i % 10 == 0 ? kSide : kDense, from = i % 10 == 0 ? 0 : kSide / 3;
    return Triple{from + upTo(random, side), from + upTo(random, side), from + upTo(random, side)};
  }));
}

TEST(Limits, AMillionExactDuplicates) {
  expectComesBack(scanOf([](int i, std::mt19937& random) {
    if (i % 11 != 0) return Triple{777'777, 123'456, 42};
    return Triple{upTo(random, 1'000'000), upTo(random, 1'000'000), upTo(random, 1000)};
  }));
}

TEST(Limits, AllOnALine) {
  expectComesBack(scanOf([](int i, std::mt19937&) { return Triple{7 * i, 5 * i, 3 * i}; }));
}

TEST(Limits, TwoClustersTenThousandKilometresApart) {
  // Only two cells of the first division have points. While such a cell is split its points are on disk twice, and each
  // thread splits one.
  constexpr double kTempShare = 1.5;
  const LasSpec spec = scanOf([](int i, std::mt19937& random) {
    const std::int32_t from = i % 2 == 0 ? -500'000'000 : 500'000'000;
    return Triple{from + upTo(random, 10'000), upTo(random, 10'000), upTo(random, 10'000)};
  });
  expectComesBack(spec, kTempShare);
}

TEST(Limits, PointsOnTheBordersOfCells) {
  expectComesBack(scanOf([](int, std::mt19937& random) {
    const auto border = [&] {
      const int bits = 3 + upTo(random, 12);
      return (upTo(random, 1 << (20 - bits)) << bits) - upTo(random, 2);
    };
    return Triple{border(), border(), border()};
  }));
}

TEST(Limits, NoExtentInOneTwoOrThreeAxes) {
  for (int axes = 1; axes <= 3; ++axes)
    expectComesBack(scanOf(
        [axes](int, std::mt19937& random) {
          Triple point{17, -4, 99};
          for (std::size_t axis = static_cast<std::size_t>(axes); axis < 3; ++axis)
            point[axis] = upTo(random, 1'000'000);
          return point;
        },
        axes == 3 ? 900'000 : kPoints));
}

TEST(Limits, AttributesThatAllVaryDoNotNeedMoreDiskThanTheInput) {
  const TempFolder folder;
  const Json result = mustConvert({"synthetic:city?points=2e6"}, folder / "a.strata", {"--memory", "512M"});
  EXPECT_LE(result.at("temp_peak_bytes").get<std::uint64_t>(), 2'000'000u * 21u);  // 12 + 9 bytes per point
  EXPECT_GT(result.at("temp_peak_bytes").get<std::uint64_t>(), 2'000'000u * 8u);   // the temporary file was needed
}

TEST(Limits, OneScanOfTenPointsAndOneOfTenMillion) {
  const TempFolder folder;
  LasSpec ten;
  ten.points = gridPoints(10);
  ten.points.resize(10);
  writeLas(folder / "ten.las", ten);
  const Json result = mustConvert({(folder / "ten.las").string(), "synthetic:plane?points=1e7"}, folder / "a.strata",
                                  {"--memory", "512M", "--threads", "8"});
  EXPECT_EQ(result.at("points"), 10'000'010);
  EXPECT_LE(result.at("peak_rss_bytes").get<std::uint64_t>(), std::uint64_t{512} << 20);
  EXPECT_EQ(mustInfo(folder / "a.strata", true).at("bad_nodes"), 0);
}

}  // namespace
}  // namespace strata::test
