#include <fstream>

#include "core/error.h"
#include "io/open_scans.h"
#include "io/scan/point_source.h"
#include "tests/support/scan_points.h"

namespace strata {
namespace {

namespace fs = std::filesystem;
using namespace test;

void write(const fs::path& path, const std::string& text) {
  fs::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << text;
}

std::string refusal(const std::string& input) {
  try {
    openScans({input}, {});
  } catch (const Error& error) {
    const std::string line = error.what();
    EXPECT_TRUE(line.starts_with(input + ": ")) << line;
    EXPECT_EQ(line.find('\n'), std::string::npos) << line;
    return line.substr(input.size() + 2);
  }
  return "";
}

TEST(OpenSources, AFolderGivesItsScansSortedAndIgnoresTheRest) {
  const TempFolder folder;
  write(folder / "b.XYZ", "1 2 3\n");
  write(folder / "a/z.pts", "1 2 3\n");
  write(folder / "a/notes.md", "not a scan");
  write(folder / "a/z.pose", "0 0 0\n");
  write(folder / "c.csv", "1,2,3\n");
  fs::create_symlink(folder / "c.csv", folder / "d.csv");
  const auto sources = openScans({folder.path().string()}, {});
  ASSERT_EQ(sources.size(), 3u);
  EXPECT_EQ(sources[0]->info().path, (folder / "a/z.pts").string());
  EXPECT_EQ(sources[1]->info().path, (folder / "b.XYZ").string());
  EXPECT_EQ(sources[2]->info().path, (folder / "c.csv").string());
}

TEST(OpenSources, TheOrderOfTheInputsIsKeptAndAFileNamedTwiceIsReadTwice) {
  const TempFolder folder;
  write(folder / "a.xyz", "1 2 3\n");
  write(folder / "b.xyz", "1 2 3\n");
  const std::string a = (folder / "a.xyz").string(), b = (folder / "b.xyz").string();
  const auto sources = openScans({b, a, b}, {});
  ASSERT_EQ(sources.size(), 3u);
  EXPECT_EQ(sources[0]->info().path, b);
  EXPECT_EQ(sources[1]->info().path, a);
  EXPECT_EQ(sources[2]->info().path, b);
}

TEST(OpenSources, EveryRefusalIsOneLineThatNamesTheInput) {
  const TempFolder folder;
  const auto path = [&](const std::string& name) { return (folder / name).string(); };
  write(folder / "empty.las", "");
  write(folder / "empty.xyz", "");
  write(folder / "wrong.laz", "nothing of the kind");
  write(folder / "wrong.ply", "nothing of the kind");
  write(folder / "las.txt", "LASF....");
  write(folder / "scan.e57", "x");
  write(folder / "scan.ptx", "x");
  write(folder / "scan.wdp", "x");
  write(folder / "scan.jpeg", "x");
  write(folder / "none/readme.md", "x");
  EXPECT_EQ(refusal(path("missing.las")), "opening: No such file or directory");
  EXPECT_EQ(refusal(path("missing")), "opening: No such file or directory");
  EXPECT_EQ(refusal(path("empty.las")), "the file is empty, found 0 bytes");
  EXPECT_EQ(refusal(path("empty.xyz")), "the file is empty, found 0 bytes");
  EXPECT_EQ(refusal(path("wrong.laz")), "this is no laz file, its first bytes are not 'LASF'");
  EXPECT_EQ(refusal(path("wrong.ply")), "this is no ply file, its first bytes are not 'ply'");
  EXPECT_NE(refusal(path("las.txt")).find("rename it"), std::string::npos);
  EXPECT_EQ(refusal(path("scan.e57")), "E57 is not read yet; export it as LAS or LAZ");
  EXPECT_EQ(refusal(path("scan.ptx")), "PTX is not read yet; export it as LAS, LAZ or PTS");
  EXPECT_NE(refusal(path("scan.wdp")), "");
  EXPECT_EQ(refusal(path("scan.jpeg")),
            "unknown kind of scan, found extension '.jpeg' (expected las, laz, ply, pcd, xyz, pts, csv, txt, asc, 3d)");
  EXPECT_NE(refusal(path("none")).find("found no scan"), std::string::npos);
}

TEST(OpenSources, SyntheticScansAreNamedWithAPrefix) {
  const auto sources = openScans({"synthetic:city?points=1000&seed=1"}, {});
  ASSERT_EQ(sources.size(), 1u);
  EXPECT_EQ(sources[0]->info().pointCount, 1000u);
}

TEST(OpenSources, TheFoldersOfRealScansOpen) {
  STRATA_REQUIRE_DATA();
  EXPECT_EQ(openScans({(dataFolder() / "text").string()}, {}).size(), expectedScans("text/").size());
  EXPECT_EQ(openScans({(dataFolder() / "las" / "basic").string()}, {}).size(), 13u);
  EXPECT_NE(refusal((dataFolder() / "e57").string()), "");
}

}  // namespace
}  // namespace strata
