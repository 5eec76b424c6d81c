// A conversion keeps its memory cap and the columns of every input.
#include "tests/support/programs.h"

namespace strata::test {
namespace {

namespace fs = std::filesystem;

TEST(Conversion, StaysUnderItsMemoryCapByWritingPointsToTheTemporaryFile) {
  const TempFolder folder;
  const Json result = mustConvert({"synthetic:plane?points=6e6"}, folder / "out.strata", {"--memory", "512M"});
  EXPECT_EQ(result.at("points"), 6000000);
  EXPECT_LE(result.at("peak_rss_bytes").get<std::uint64_t>(), std::uint64_t{512} << 20);
  EXPECT_GT(result.at("temp_peak_bytes"), 0);
  EXPECT_EQ(mustInfo(folder / "out.strata", true).at("bad_nodes"), 0);
}

// The scan has 19 chunks. Some of them lie in one cell, so that merging takes two rounds.
TEST(Conversion, WithManyChunksGivesTheSameBytesForAnyNumberOfThreads) {
  const TempFolder folder;
  for (const char* threads : {"1", "2", "8"})
    mustConvert({"synthetic:city?points=3e6&seed=3"}, folder / (std::string(threads) + ".strata"),
                {"--memory", "512M", "--threads", threads});
  EXPECT_TRUE(sameStores(folder / "1.strata", folder / "2.strata"));
  EXPECT_TRUE(sameStores(folder / "1.strata", folder / "8.strata"));
  EXPECT_EQ(mustInfo(folder / "8.strata", true).at("bad_nodes"), 0);
}

TEST(Conversion, TakesTheColumnsThatTheUserNames) {
  const TempFolder folder;
  writeBytes(folder / "scan.txt", "7 1 2 3\n8 4 5 6\n");
  mustConvert({(folder / "scan.txt").string()}, folder / "out.strata", {"--columns", "intensity,z,y,x"});
  const Json bounds = mustInfo(folder / "out.strata").at("bounds");
  EXPECT_EQ(bounds.at("min"), Json({3.0, 2.0, 1.0}));
  EXPECT_EQ(bounds.at("max"), Json({6.0, 5.0, 4.0}));
}

TEST(Conversion, RefusesColumnsThatMakeNoSense) {
  const TempFolder folder;
  writeBytes(folder / "scan.txt", "7 1 2 3\n8 4 5 6\n");
  for (const char* columns : {"x,y", "x,y,z,nonsense", "x,y,z,x", ""}) {
    const Finished finished = convert({(folder / "scan.txt").string()}, folder / "out.strata", {"--columns", columns});
    EXPECT_TRUE(*columns == '\0' || finished.exitCode == 1 || finished.exitCode == 2) << columns;
    EXPECT_LE(linesOf(finished.err).size(), 1u) << finished.err;
  }
}

TEST(Conversion, TakesFilesOfDifferentFormatsAsOneCloud) {
  const TempFolder folder;
  LasSpec spec;
  spec.points = gridPoints(20);
  writeLas(folder / "a.las", spec);
  spec.versionMinor = 4;
  spec.format = 7;
  spec.scale = {0.001, 0.001, 0.001};
  spec.offset = {50.0005, 0.0, 0.0};
  writeLas(folder / "b.las", spec);
  writeBytes(folder / "c.ply",
             "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
             "property float nx\nproperty float ny\nproperty float nz\nend_header\n1 2 3 0 0 1\n4 5 6 0 1 0\n");
  writeBytes(folder / "d.csv", "x,y,z,intensity\n1,2,3,4\n");
  const Json result = mustConvert({folder.path().string()}, folder / "out.strata");
  EXPECT_EQ(result.at("points"), 803);
  const Json info = mustInfo(folder / "out.strata", true);
  EXPECT_EQ(info.at("bad_nodes"), 0);
  EXPECT_EQ(mustExport(folder / "out.strata", folder / "back.las").count, 803u);
}

}  // namespace
}  // namespace strata::test
