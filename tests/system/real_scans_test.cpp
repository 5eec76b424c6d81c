// Real scans have the counts and bounds that independent programs found in them.
#include "tests/support/real_scans.h"
#include "tests/support/las_decoder.h"
#include "tests/support/programs.h"

namespace strata::test {
namespace {

namespace fs = std::filesystem;

/// E57, PTX, and files that are damaged, empty or no scans. The last one lacks only its last record.
bool mustBeRefused(const RealScan& scan) {
  return scan.points == 0 || scan.ending() == ".e57" || scan.ending() == ".ptx" ||
         scan.file == "las/edge/1.2-with-color-clipped.las";
}

class SoundScan : public testing::TestWithParam<RealScan> {};
class RefusedScan : public testing::TestWithParam<RealScan> {};
class LasScan : public testing::TestWithParam<RealScan> {};

TEST_P(SoundScan, ConvertsWithTheExpectedCountAndBounds) {
  STRATA_REQUIRE_DATA();
  const TempFolder folder;
  const RealScan& scan = GetParam();
  const Finished finished = convert({scan.path().string()}, folder / "scan.strata");
  ASSERT_EQ(finished.exitCode, 0) << finished.err;
  const Json result = lastLine(finished);
  EXPECT_EQ(result.at("points").get<std::uint64_t>() + result.at("skipped").get<std::uint64_t>(), scan.points);
  if (scan.isLas()) {
    EXPECT_EQ(result.at("skipped"), 0);
  }

  const Json info = mustInfo(folder / "scan.strata", true);
  EXPECT_EQ(info.at("bad_nodes"), 0);
  const std::vector<double> low = triple(scan.min), high = triple(scan.max);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(info.at("bounds").at("min").at(axis).get<double>(), low[axis], printedTolerance(low[axis]));
    EXPECT_NEAR(info.at("bounds").at("max").at(axis).get<double>(), high[axis], printedTolerance(high[axis]));
  }
}

INSTANTIATE_TEST_SUITE_P(Real, SoundScan, testing::ValuesIn(scansWhere([](const RealScan& scan) {
                           return !mustBeRefused(scan) && !scan.isTile();
                         })),
                         testName);

TEST_P(RefusedScan, IsRefusedInOneLineThatNamesIt) {
  STRATA_REQUIRE_DATA();
  const TempFolder folder;
  const RealScan& scan = GetParam();
  const Finished finished = convert({scan.path().string()}, folder / "scan.strata");
  expectRefused(finished, folder / "scan.strata");
  EXPECT_TRUE(mentions(finished, fs::path(scan.file).filename().string())) << finished.err;
  EXPECT_LT(finished.seconds, 5.0);
  EXPECT_TRUE(scan.ending() != ".e57" || mentions(finished, "E57")) << finished.err;
  EXPECT_TRUE(scan.ending() != ".ptx" || mentions(finished, "PTX")) << finished.err;
}

INSTANTIATE_TEST_SUITE_P(Real, RefusedScan, testing::ValuesIn(scansWhere(mustBeRefused)), testName);

TEST_P(LasScan, ComesBackBitForBit) {
  STRATA_REQUIRE_DATA();
  expectRecordsComeBack(GetParam());
}

// The tiles and the large file are in large_scans_test.cpp.
bool isRoundTripped(const RealScan& scan) {
  const int format = scan.pointFormat();
  return scan.isLas() && !mustBeRefused(scan) && !scan.isTile() && scan.points < 1000000 &&
         (format <= 3 || (format >= 6 && format <= 8));
}

INSTANTIATE_TEST_SUITE_P(Real, LasScan, testing::ValuesIn(scansWhere(isRoundTripped)), testName);

TEST(RealScans, AScanCutShortConvertsWithoutItsLastRecordWhereDamageIsAccepted) {
  STRATA_REQUIRE_DATA();
  const TempFolder folder;
  const fs::path clipped = dataFolder() / "las/edge/1.2-with-color-clipped.las";
  const Json result = mustConvert({clipped.string()}, folder / "scan.strata", {"--skip-damaged"});
  EXPECT_EQ(result.at("points"), 1064);
  EXPECT_EQ(result.at("skipped"), 1);
}

TEST(RealScans, ColoursKeptAsEightBitsInSixteenAreRecognised) {
  STRATA_REQUIRE_DATA();
  const std::pair<const char*, int> shifts[] = {{"las/basic/simple.las", 0},
                                                {"copc/ellipsoid.copc.laz", 0},
                                                {"laz/lion/r.laz", 8},
                                                {"copc/lion_takanawa.copc.laz", 8}};
  for (const auto& [file, shift] : shifts) {
    const TempFolder folder;
    mustConvert({(dataFolder() / file).string()}, folder / "scan.strata");
    EXPECT_EQ(Json::parse(readWhole(folder / "scan.strata" / "store.json")).at("colour_shift"), shift) << file;
  }
}

TEST(RealScans, TheTilesOfRedRocksAreTheSamePointsAsTheSingleFile) {
  STRATA_REQUIRE_DATA();
  const TempFolder folder;
  mustConvert({(dataFolder() / "laz/large/red_rocks_4.0M.laz").string()}, folder / "single.strata");
  mustConvert({(dataFolder() / "laz/red-rocks-tiles").string()}, folder / "tiles.strata");
  EXPECT_EQ(mustInfo(folder / "tiles.strata").at("bounds"), mustInfo(folder / "single.strata").at("bounds"));
  const LasFile single = mustExport(folder / "single.strata", folder / "single.las");
  const LasFile tiles = mustExport(folder / "tiles.strata", folder / "tiles.las");
  ASSERT_EQ(single.count, 4004326u);
  ASSERT_EQ(tiles.count, single.count);
  EXPECT_EQ(tiles.scale, single.scale);
  EXPECT_EQ(tiles.offset, single.offset);
  EXPECT_TRUE(tiles.sortedRecords() == single.sortedRecords());
}

}  // namespace
}  // namespace strata::test
