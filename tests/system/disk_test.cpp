// Disks that are too small, and folders that vanish in the middle of a conversion.
#include <fstream>

#include "converter/convert.h"
#include "converter/journal/build_folder.h"
#include "core/error.h"
#include "tests/support/interrupted.h"

namespace strata::test {
namespace {

namespace fs = std::filesystem;

TEST(Disk, ALimitOnTheSizeOfFilesEndsTheConversionWhichLeavesNothing) {
  const TempFolder folder;
  const fs::path store = folder / "a.strata", temp = folder / "temp";
  fs::create_directory(temp);
  // The largest size of a file in KiB. The temporary points, points.bin and the journal reach it in turn.
  for (const char* most : {"8000", "1000", "100", "4"}) {
    std::string command =
        std::string("trap '' XFSZ; ulimit -f ") + most + "; exec " + programPath("strata-convert").string();
    for (const std::string& word : convertWords(kScan, store, {"--temp", temp.string()})) command += " '" + word + "'";
    const Finished finished = runProgram("/bin/bash", {"-c", command});
    expectRefused(finished, store);
    EXPECT_TRUE(fs::is_empty(temp)) << most;
    EXPECT_FALSE(fs::exists(buildingOf(store))) << most;
  }
}

TEST(Disk, AFullDiskEndsTheConversionAndIsAsEmptyAsBefore) {
  const TempFolder folder;
  // Only the commands that `unshare` runs see this file system, which lies in memory.
  const std::string disk = (folder / "disk").string();
  fs::create_directory(disk);
  const auto onDisk = [&](const std::string& size, const std::string& command) {
    return runProgram("/usr/bin/unshare",
                      {"-Urm", "/bin/sh", "-c", "mount -t tmpfs -o size=" + size + " none " + disk + " && " + command});
  };
  if (!fs::exists("/usr/bin/unshare") || onDisk("1m", "true").exitCode != 0)
    GTEST_SKIP() << "a file system cannot be mounted here";
  int full = 0;
  for (const char* size : {"64k", "1m", "12m", "20m", "26m", "30m", "34m", "200m"}) {
    std::string command = programPath("strata-convert").string();
    for (const std::string& word : convertWords(kScan, disk + "/a.strata", {})) command += " '" + word + "'";
    const Finished finished = onDisk(size, command + "; code=$?; ls -A " + disk + " >&2; exit $code");
    if (finished.exitCode == 0) {
      EXPECT_EQ(finished.err.substr(finished.err.rfind('\n', finished.err.size() - 2) + 1), "a.strata\n") << size;
      continue;
    }
    ++full;
    expectFailure(finished);  // its one line is the error, so `ls` found nothing
    EXPECT_TRUE(mentions(finished, "No space left")) << finished.err;
  }
  EXPECT_GE(full, 4);
  EXPECT_LT(full, 8);
}

/// Converts, removes `lost` when `stage` begins, and returns the message of the Error that follows.
std::string messageWithout(const fs::path& lost, const std::string& stage, const ConvertOptions& options) {
  ConvertControl control;
  control.progress = [&](const Progress& progress) {
    if (progress.stage == stage) fs::remove_all(lost);
  };
  try {
    convert(options, control);
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

TEST(Disk, AFolderThatVanishesIsNamedAndTheInputStaysAsItWas) {
  for (const char* stage : {stage::kDistribute, stage::kBuild, stage::kMerge, stage::kWrite}) {
    const TempFolder folder;
    const fs::path scan = folder / "scan.las", place = folder / "place", temp = folder / "temp";
    LasSpec spec;
    spec.points = gridPoints(150);
    writeLas(scan, spec);
    const std::string before = readWhole(scan);
    for (const fs::path& lost : {place, place / "a.strata.building"}) {
      fs::create_directories(place);
      fs::create_directories(temp);
      ConvertOptions options;
      options.inputs = {scan.string()};
      options.output = (place / "a.strata").string();
      options.tempFolder = temp.string();
      const std::string message = messageWithout(lost, stage, options);
      EXPECT_NE(message.find("a.strata"), std::string::npos) << stage << ": " << message;
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
      EXPECT_TRUE(fs::is_empty(temp)) << stage;
      EXPECT_FALSE(fs::exists(place / "a.strata")) << stage;
      EXPECT_EQ(readWhole(scan), before);
    }
  }
}

TEST(Disk, ResumeSaysThatTheTemporaryPointsAreGone) {
  const TempFolder folder;
  const fs::path store = folder / "a.strata", temp = folder / "temp";
  fs::create_directory(temp);
  leaveInterrupted(kScan, store, {"--temp", temp.string()});
  fs::remove_all(temp);
  fs::create_directory(temp);
  const Words options{"--temp", temp.string(), "--resume"};
  const Finished gone = runProgram("strata-convert", convertWords(kScan, store, options));
  expectRefused(gone, store);
  EXPECT_TRUE(mentions(gone, "gone") && mentions(gone, "--force")) << gone.err;
  EXPECT_TRUE(fs::exists(buildingOf(store) / "journal"));
  EXPECT_EQ(runProgram("strata-convert", convertWords(kScan, store, {"--force"})).exitCode, 0);
}

}  // namespace
}  // namespace strata::test
