// Scans that are odd but correct are converted, and every coordinate comes through.
#include <algorithm>
#include <fstream>
#include <limits>

#include "tests/support/programs.h"

namespace strata::test {
namespace {

class OddInput : public testing::Test {
 protected:
  std::string las(const LasSpec& spec) const {
    writeLas(folder_ / "scan.las", spec);
    return (folder_ / "scan.las").string();
  }
  /// Converts a scan, checks the store, exports it, and expects exactly the records of the input.
  void expectRoundTrip(const LasSpec& spec, const std::vector<std::string>& options = {}) const {
    const std::string input = las(spec);
    const Json result = mustConvert({input}, folder_ / "out.strata", options);
    EXPECT_EQ(result.at("points"), spec.points.size());
    EXPECT_EQ(result.at("skipped"), 0);
    EXPECT_EQ(mustInfo(folder_ / "out.strata", true).at("bad_nodes"), 0);
    const LasFile before = readLas(input);
    const LasFile after = mustExport(folder_ / "out.strata", folder_ / "back.las");
    EXPECT_EQ(after.format, before.format);
    EXPECT_EQ(after.scale, before.scale);
    EXPECT_EQ(after.offset, before.offset);
    EXPECT_TRUE(after.sortedRecords() == before.sortedRecords());
  }
  /// Compares the bounds that strata-info prints with those of the points.
  void expectTightBounds(const LasSpec& spec) const {
    const Json bounds = mustInfo(folder_ / "out.strata").at("bounds");
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto [low, high] = std::minmax_element(spec.points.begin(), spec.points.end(),
                                                   [axis](const auto& a, const auto& b) { return a[axis] < b[axis]; });
      EXPECT_NEAR(bounds.at("min").at(axis).get<double>(), spec.offset[axis] + spec.scale[axis] * (*low)[axis],
                  spec.scale[axis] * 1e-3);
      EXPECT_NEAR(bounds.at("max").at(axis).get<double>(), spec.offset[axis] + spec.scale[axis] * (*high)[axis],
                  spec.scale[axis] * 1e-3);
    }
  }

  TempFolder folder_;
};

LasSpec gridScan(int n = 60) {
  LasSpec spec;
  spec.points = gridPoints(n);
  return spec;
}

TEST_F(OddInput, OnePointConverts) {
  LasSpec spec;
  spec.points = {{123, -456, 789}};
  expectRoundTrip(spec);
  expectTightBounds(spec);
}

TEST_F(OddInput, PointsThatAreAllEqualConvert) {
  LasSpec spec;
  spec.points.assign(5000, {7, 8, 9});
  expectRoundTrip(spec);
  expectTightBounds(spec);
}

TEST_F(OddInput, MoreEqualPointsThanANodeHoldsConvert) {
  LasSpec spec;
  spec.points.assign(5000, {7, 8, 9});
  expectRoundTrip(spec, {"--node-points", "1024"});
}

TEST_F(OddInput, TwentyThousandCopiesOfOnePointBesideAHundredOthersAllStay) {
  LasSpec spec;
  spec.points.assign(20000, {5000, 5000, 10});
  const auto others = gridPoints(10, 1000);
  spec.points.insert(spec.points.end(), others.begin(), others.end());
  expectRoundTrip(spec);
  expectRoundTrip(spec, {"--force", "--node-points", "1024"});
}

TEST_F(OddInput, APlaneAndALineConvert) {
  LasSpec plane = gridScan();
  for (auto& point : plane.points) point[2] = 0;
  expectRoundTrip(plane);
  LasSpec line;
  for (int i = 0; i < 3000; ++i) line.points.push_back({i * 3, 0, 0});
  expectRoundTrip(line, {"--force"});
}

TEST_F(OddInput, TheWholeRangeOfLasIntegersConverts) {
  LasSpec spec;
  const std::int32_t low = std::numeric_limits<std::int32_t>::min();
  const std::int32_t high = std::numeric_limits<std::int32_t>::max();
  spec.points = {{low, low, low}, {high, high, high}, {0, 0, 0}, {low, high, 1}, {-1, 1, high}};
  expectRoundTrip(spec);
}

TEST_F(OddInput, AnOutlierTwoThousandKilometresAwayMakesTheOtherPointsNoCoarser) {
  LasSpec spec = gridScan();
  spec.scale = {0.001, 0.001, 0.001};
  spec.offset = {482000.0, 4390000.0, 1800.0};
  spec.points.push_back({2000000000, 0, 0});
  expectRoundTrip(spec);
  expectTightBounds(spec);
}

TEST_F(OddInput, UtmCoordinatesOfATenthOfAMillimetreComeBack) {
  LasSpec spec = gridScan();
  spec.scale = {0.0001, 0.0001, 0.0001};
  spec.offset = {482411.97, 4390628.5, 1890.58};
  expectRoundTrip(spec);
}

TEST_F(OddInput, ScalesThatDifferByAxisComeBack) {
  LasSpec spec = gridScan();
  spec.scale = {1e-7, 1e-7, 0.01};
  spec.offset = {-94.68, 31.05, 0.0};
  expectRoundTrip(spec);
}

TEST_F(OddInput, HeaderBoundsThatLieDoNotMatter) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  struct Lie {
    const char* name;
    LasSpec::Triple min, max;
  };
  const Lie lies[] = {{"NaN", {nan, nan, nan}, {nan, nan, nan}},
                      {"infinite", {-infinity, -infinity, -infinity}, {infinity, infinity, infinity}},
                      {"far too large", {-1e12, -1e12, -1e12}, {1e12, 1e12, 1e12}},
                      {"far too small", {1.0, 1.0, 0.1}, {1.01, 1.01, 0.11}},
                      {"elsewhere", {9000.0, 9000.0, 9000.0}, {9001.0, 9001.0, 9001.0}},
                      {"inverted", {5.0, 5.0, 0.5}, {0.0, 0.0, 0.0}}};
  for (const Lie& lie : lies) {
    SCOPED_TRACE(lie.name);
    LasSpec spec = gridScan();
    spec.claimedMin = lie.min;
    spec.claimedMax = lie.max;
    expectRoundTrip(spec, {"--force"});
    expectTightBounds(spec);
  }
}

TEST_F(OddInput, EveryPointFormatComesBack) {
  for (const int format : {0, 1, 2, 3, 6, 7, 8}) {
    SCOPED_TRACE(format);
    LasSpec spec = gridScan(30);
    spec.format = format;
    spec.versionMinor = format < 6 ? 2 : 4;
    expectRoundTrip(spec, {"--force"});
  }
}

TEST_F(OddInput, NamesWithSpacesAndUmlautsWork) {
  const std::string name = (folder_ / "Haus Süd (2).las").string();
  writeLas(name, gridScan(10));
  EXPECT_EQ(mustConvert({name}, folder_ / "Haus Süd (2).strata").at("points"), 100);
  EXPECT_EQ(mustInfo(folder_ / "Haus Süd (2).strata").at("points"), 100);
}

TEST_F(OddInput, PointsAtTheOriginMakeTheGridNoFiner) {
  std::string ply =
      "ply\nformat binary_little_endian 1.0\nelement vertex 300\nproperty float x\nproperty float y\n"
      "property float z\nend_header\n";
  for (int i = 0; i < 300; ++i) {
    const bool met = i % 3 == 0;  // scanners write (0, 0, 0) for a ray that met nothing
    const float place[3] = {met ? 10.0f + 0.1f * static_cast<float>(i) : 0.0f, met ? 5.0f : 0.0f, met ? -2.5f : 0.0f};
    ply.append(reinterpret_cast<const char*>(place), sizeof place);
  }
  std::ofstream(folder_ / "rays.ply", std::ios::binary) << ply;
  EXPECT_EQ(mustConvert({(folder_ / "rays.ply").string()}, folder_ / "out.strata").at("points"), 300);
  const Json bounds = mustInfo(folder_ / "out.strata", true).at("bounds");
  EXPECT_NEAR(bounds.at("max").at(0).get<double>(), 39.7, 1e-5);
  EXPECT_NEAR(bounds.at("min").at(2).get<double>(), -2.5, 1e-5);
}

TEST_F(OddInput, RecordsBehindTheCountedPointsAreWarnedOf) {
  LasSpec spec = gridScan(10);
  const std::string input = las(spec);
  EXPECT_EQ(runProgram("strata-convert", {input, "-o", (folder_ / "all.strata").string()}).err.find("more behind them"),
            std::string::npos);
  spec.claimedPoints = 60;
  const Finished finished = runProgram("strata-convert", {las(spec), "-o", (folder_ / "some.strata").string()});
  EXPECT_EQ(finished.exitCode, 0);
  EXPECT_NE(finished.err.find("the header counts 60 points, found room for 40 more behind them, which are not read"),
            std::string::npos)
      << finished.err;
  EXPECT_EQ(mustInfo(folder_ / "some.strata").at("points"), 60);
}

TEST_F(OddInput, ChunksBehindTheCountedPointsAreWarnedOf) {
  mustConvert({"synthetic:city?points=120000&seed=1"}, folder_ / "city.strata");
  const std::string laz = (folder_ / "city.laz").string();
  ASSERT_EQ(runProgram("strata-export", {(folder_ / "city.strata").string(), "-o", laz, "--format", "7"}).exitCode, 0);
  EXPECT_EQ(runProgram("strata-convert", {laz, "-o", (folder_ / "all.strata").string()}).err.find("more behind them"),
            std::string::npos);
  const std::uint64_t counted = 60000;  // lie in three chunks of at most 50,000
  std::fstream header(laz, std::ios::binary | std::ios::in | std::ios::out);
  header.seekp(247);  // where LAS 1.4 has the number of point records
  header.write(reinterpret_cast<const char*>(&counted), sizeof counted);
  header.close();
  const Finished finished = runProgram("strata-convert", {laz, "-o", (folder_ / "some.strata").string()});
  EXPECT_EQ(finished.exitCode, 0) << finished.err;
  EXPECT_NE(finished.err.find("the header counts 60000 points, found room for "), std::string::npos) << finished.err;
  EXPECT_EQ(mustInfo(folder_ / "some.strata").at("points"), 60000);
}

TEST_F(OddInput, TheSameFileTwiceCountsTwice) {
  const std::string input = las(gridScan(10));
  EXPECT_EQ(mustConvert({input, input}, folder_ / "out.strata").at("points"), 200);
}

}  // namespace
}  // namespace strata::test
