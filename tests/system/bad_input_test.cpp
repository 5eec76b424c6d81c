// Runs the programs with every input that can go wrong, and expects the exit code, one line on stderr, and no
// incomplete folder with the store's name.
#include <sys/mount.h>
#include <unistd.h>

#include <cmath>

#include "tests/support/programs.h"

namespace strata::test {
namespace {

namespace fs = std::filesystem;

class BadInput : public testing::Test {
 protected:
  std::string file(const std::string& name, const std::string& bytes) const {
    writeBytes(folder_ / name, bytes);
    return (folder_ / name).string();
  }
  std::string las(const std::string& name, const LasSpec& spec) const { return file(name, lasBytes(spec)); }
  fs::path store() const { return folder_ / "out.strata"; }
  void expectRefusal(const std::string& input, const std::string& words) const {
    const Finished finished = convert({input}, store());
    expectRefused(finished, store());
    EXPECT_TRUE(mentions(finished, fs::path(input).filename().string())) << "no file named: " << finished.err;
    EXPECT_TRUE(mentions(finished, words)) << finished.err;
  }

  TempFolder folder_;
};

LasSpec soundScan(int n = 10) {
  LasSpec spec;
  spec.points = gridPoints(n);
  return spec;
}

TEST_F(BadInput, AMissingFileIsNamed) { expectRefusal((folder_ / "missing.las").string(), "No such file"); }

TEST_F(BadInput, AFolderWithoutScansIsRefused) {
  fs::create_directory(folder_ / "papers");
  file("papers/readme.md", "no scan");
  expectRefusal((folder_ / "papers").string(), "");
}

TEST_F(BadInput, ALinkToItselfIsRefusedByName) {
  std::filesystem::create_symlink(folder_ / "loop", folder_ / "loop");
  expectRefusal((folder_ / "loop").string(), "loop: ");
}

TEST_F(BadInput, AnEmptyFileIsRefused) {
  for (const char* ending : {"las", "laz", "ply", "pcd", "xyz", "pts", "csv", "txt"})
    expectRefusal(file(std::string("empty.") + ending, ""), "");
}

TEST_F(BadInput, AFileOfGarbageIsRefused) {
  std::string garbage;
  for (int i = 0; i < 5000; ++i) garbage += static_cast<char>(i * 7919 >> 3);
  for (const char* ending : {"las", "laz", "ply", "pcd", "xyz", "pts", "csv", "txt"})
    expectRefusal(file(std::string("garbage.") + ending, garbage), "");
}

TEST_F(BadInput, AScanWithoutPointsIsRefused) {
  expectRefusal(las("none.las", LasSpec{}), "");
  expectRefusal(file("none.ply",
                     "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\n"
                     "property float z\nend_header\n"),
                "");
  expectRefusal(file("none.csv", "x,y,z\n"), "");
}

TEST_F(BadInput, AnUnknownEndingIsRefused) { expectRefusal(file("scan.docx", "1 2 3\n"), ""); }

TEST_F(BadInput, FormatsThatAreNotReadYetAreRefusedByName) {
  expectRefusal(file("scan.e57", "ASTM-E57"), "E57");
  expectRefusal(file("scan.ptx", "1\n1\n0 0 0\n"), "PTX");
}

TEST_F(BadInput, ABodyCutInARecordIsRefused) {
  LasSpec spec = soundScan();
  spec.keepBytes = lasBytes(spec).size() - 30;
  expectRefusal(las("cut.las", spec), "");
}

TEST_F(BadInput, AHeaderCutShortIsRefused) {
  for (const std::uint64_t keep : {4, 100, 200, 226}) {
    LasSpec spec = soundScan();
    spec.keepBytes = keep;
    expectRefusal(las("cut.las", spec), "");
  }
}

TEST_F(BadInput, AHeaderThatPromisesMorePointsThanThereAreIsRefused) {
  LasSpec spec = soundScan();
  spec.claimedPoints = 150;
  expectRefusal(las("short.las", spec), "150");
}

TEST_F(BadInput, SkippingDamageKeepsTheSoundPointsAndCountsTheOthers) {
  LasSpec spec = soundScan();
  spec.claimedPoints = 150;
  const Json result = mustConvert({las("short.las", spec)}, store(), {"--skip-damaged"});
  EXPECT_EQ(result.at("points"), 100);
  EXPECT_EQ(result.at("skipped"), 50);
}

TEST_F(BadInput, OneDamagedFileAmongSoundOnesIsNamed) {
  las("a.las", soundScan());
  LasSpec cut = soundScan();
  cut.keepBytes = 400;
  const std::string damaged = las("b.las", cut);
  const Finished finished = convert({(folder_ / "a.las").string(), damaged}, store());
  expectRefused(finished, store());
  EXPECT_TRUE(mentions(finished, "b.las")) << finished.err;
}

TEST_F(BadInput, FourBillionClaimedPointsInASmallFileAreRefusedAtOnce) {
  LasSpec spec = soundScan();
  spec.claimedPoints = 4000000000u;
  const std::string las12 = las("claims.las", spec);
  spec.versionMinor = 4;
  spec.format = 6;
  spec.claimedPoints = 4000000000000u;
  const std::string las14 = las("claims14.las", spec);
  const std::string vertices = file("claims.ply",
                                    "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\n"
                                    "property float x\nproperty float y\nproperty float z\nend_header\nabc");
  const std::string columns = file("claims.pcd",
                                   "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n"
                                   "WIDTH 4000000000\nHEIGHT 1\nPOINTS 4000000000\nDATA binary\nabc");
  for (const std::string& input : {las12, las14, vertices, columns}) {
    const Finished finished = convert({input}, store());
    expectRefused(finished, store());
    EXPECT_LT(finished.seconds, 2.0) << input;
  }
}

TEST_F(BadInput, ADataOffsetPastTheEndIsRefused) {
  LasSpec spec = soundScan();
  spec.claimedDataOffset = 1u << 30;
  expectRefusal(las("offset.las", spec), "");
  spec.claimedDataOffset = 10;
  expectRefusal(las("offset.las", spec), "");
}

TEST_F(BadInput, ARecordLengthOfZeroOrTooShortIsRefused) {
  for (const int length : {0, 1, 12, 19}) {
    LasSpec spec = soundScan();
    spec.claimedRecordBytes = static_cast<std::uint16_t>(length);
    expectRefusal(las("record.las", spec), "");
  }
}

TEST_F(BadInput, AZeroScaleIsRefused) {
  LasSpec spec = soundScan();
  spec.scale = {0.01, 0.0, 0.01};
  expectRefusal(las("flat.las", spec), "scale");
  spec.scale = {0.01, std::nan(""), 0.01};
  expectRefusal(las("nan.las", spec), "scale");
}

TEST_F(BadInput, PointsThatAreNotFiniteAreSkippedAndCounted) {
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n"
      "property float z\nend_header\n";
  const std::string ply = file("some.ply", header + "0 0 0\nnan 1 1\n1 inf 1\n1 1 -inf\n2 3 4\n");
  const std::string csv = file("some.csv", "x,y,z\n0,0,0\nnan,1,1\n1,inf,1\n1,1,-inf\n2,3,4\n");
  for (const std::string& input : {ply, csv}) {
    const Json result = mustConvert({input}, store(), {"--force"});
    EXPECT_EQ(result.at("points"), 2) << input;
    EXPECT_EQ(result.at("skipped"), 3) << input;
    const Json info = mustInfo(store(), true);
    EXPECT_EQ(info.at("bounds").at("min"), Json({0.0, 0.0, 0.0})) << input;
    EXPECT_EQ(info.at("bounds").at("max"), Json({2.0, 3.0, 4.0})) << input;
    EXPECT_EQ(info.at("bad_nodes"), 0);
  }
}

TEST_F(BadInput, AScanOfNothingButNanIsRefused) {
  expectRefusal(file("nan.ply",
                     "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
                     "property float z\nend_header\nnan nan nan\nnan 0 0\n"),
                "");
  expectRefusal(file("nan.csv", "x,y,z\nnan,nan,nan\n"), "");
}

TEST_F(BadInput, AnUnreadableFolderIsNamed) {
  const fs::path closed = folder_ / "closed";
  fs::create_directory(closed);
  writeLas(closed / "scan.las", soundScan());
  fs::permissions(closed, fs::perms::none);
  fs::permissions(folder_.path(), fs::perms::all);
  RunOptions options;
  options.asNobody = geteuid() == 0;
  if (options.asNobody && runProgram("strata-convert", {"--help"}, options).exitCode != 0)
    GTEST_SKIP() << "as root every folder is readable, and another user cannot run the programs here";
  const Finished finished = runProgram("strata-convert", {closed.string(), "-o", store().string()}, options);
  expectRefused(finished, store());
  EXPECT_TRUE(mentions(finished, "closed")) << finished.err;
  EXPECT_TRUE(mentions(finished, "Permission denied")) << finished.err;
  fs::permissions(closed, fs::perms::all);
}

/// A file system with little room, which exists as long as the object.
class SmallDisk {
 public:
  SmallDisk(const fs::path& at, const char* size) : at_(at) {
    fs::create_directory(at_);
    mounted_ = mount("tmpfs", at_.c_str(), "tmpfs", 0, (std::string("size=") + size).c_str()) == 0;
  }
  ~SmallDisk() {
    if (mounted_) umount(at_.c_str());
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  bool mounted() const { return mounted_; }

 private:
  fs::path at_;
  bool mounted_ = false;
};

TEST_F(BadInput, NoSpaceLeftForTheStoreIsReportedAndNothingRemains) {
  const fs::path disk = folder_ / "disk";
  const SmallDisk small(disk, "600k");
  if (!small.mounted()) GTEST_SKIP() << "a small file system can be mounted only as root";
  fs::create_directory(folder_ / "temp");
  const Finished finished =
      convert({"synthetic:city?points=200000"}, disk / "out.strata", {"--temp", (folder_ / "temp").string()});
  expectRefused(finished, disk / "out.strata");
  EXPECT_TRUE(mentions(finished, "No space left")) << finished.err;
  EXPECT_TRUE(fs::is_empty(folder_ / "temp"));
}

TEST_F(BadInput, NoSpaceLeftForTemporaryFilesIsReportedAndNothingRemains) {
  const fs::path disk = folder_ / "disk";
  const SmallDisk small(disk, "600k");
  if (!small.mounted()) GTEST_SKIP() << "a small file system can be mounted only as root";
  const Finished finished =  // more points than fit this memory at once, so that some go to the temporary file
      convert({"synthetic:plane?points=6e6"}, store(), {"--temp", disk.string(), "--memory", "512M"});
  expectRefused(finished, store());
  EXPECT_TRUE(mentions(finished, "No space left")) << finished.err;
  EXPECT_TRUE(fs::is_empty(disk));
}

TEST_F(BadInput, AnOutputThatExistsNeedsForce) {
  const std::string input = las("scan.las", soundScan());
  mustConvert({input}, store());
  const std::string before = readWhole(store() / "points.bin");
  const Finished again = convert({input}, store());
  expectFailure(again);
  EXPECT_TRUE(mentions(again, "--force")) << again.err;
  EXPECT_EQ(readWhole(store() / "points.bin"), before);
  mustConvert({las("other.las", soundScan(20))}, store(), {"--force"});
  EXPECT_EQ(mustInfo(store()).at("points"), 400);
}

TEST_F(BadInput, ForceNeverReplacesAFolderThatIsNoStore) {
  const fs::path letters = folder_ / "letters.strata";
  fs::create_directory(letters);
  writeBytes(letters / "letter.txt", "dear reader");
  const Finished finished = convert({las("scan.las", soundScan())}, letters, {"--force"});
  expectFailure(finished);
  EXPECT_EQ(readWhole(letters / "letter.txt"), "dear reader");
}

TEST_F(BadInput, AFailedConversionWithForceKeepsTheOldStore) {
  mustConvert({las("scan.las", soundScan())}, store());
  LasSpec cut = soundScan();
  cut.keepBytes = 400;
  expectFailure(convert({las("cut.las", cut)}, store(), {"--force"}));
  EXPECT_EQ(mustInfo(store(), true).at("points"), 100);
}

TEST_F(BadInput, AnOutputInAMissingFolderIsRefused) {
  const Finished finished = convert({las("scan.las", soundScan())}, folder_ / "no" / "such" / "out.strata");
  expectRefused(finished, folder_ / "no");
}

}  // namespace
}  // namespace strata::test
