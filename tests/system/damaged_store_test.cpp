// `strata-info --verify` finds every bit that was changed in a store after the conversion.
#include <random>

#include "tests/support/programs.h"

namespace strata::test {
namespace {

namespace fs = std::filesystem;

/// A small store of several nodes, and a copy that the test damages.
class DamagedStore : public testing::Test {
 protected:
  DamagedStore() {
    mustConvert({"synthetic:room?points=6000"}, sound_, {"--node-points", "1024"});
    fs::create_directory(damaged_);
    restore();
  }
  void restore() const {
    for (const char* name : {"store.json", "hierarchy.bin", "points.bin"})
      fs::copy_file(sound_ / name, damaged_ / name, fs::copy_options::overwrite_existing);
  }
  void flip(const std::string& name, std::size_t at, int bit) const {
    std::string bytes = readWhole(damaged_ / name);
    bytes.at(at) = static_cast<char>(bytes.at(at) ^ (1 << bit));
    writeBytes(damaged_ / name, bytes);
  }
  Finished verify() const { return runProgram("strata-info", {damaged_.string(), "--verify", "--json"}); }
  void expectFound(const std::string& what) const {
    const Finished finished = verify();
    EXPECT_EQ(finished.exitCode, 1) << what << "\n" << finished.out << finished.err;
    EXPECT_EQ(finished.err.rfind("error: ", 0), 0u) << what << "\n" << finished.err;
  }

  TempFolder folder_;
  const fs::path sound_ = folder_ / "sound.strata";
  const fs::path damaged_ = folder_ / "damaged.strata";
};

TEST_F(DamagedStore, AnUntouchedCopyIsSound) {
  const Json info = mustInfo(damaged_, true);
  EXPECT_EQ(info.at("points"), 6000);
  EXPECT_EQ(info.at("checked_nodes"), info.at("nodes"));
  EXPECT_EQ(info.at("bad_nodes"), 0);
  EXPECT_GT(info.at("nodes"), 1);
}

TEST_F(DamagedStore, AFlippedBitIsFoundInEveryRegionOfEveryFile) {
  constexpr std::size_t kRegions = 32;
  std::mt19937 random(7);
  for (const std::string name : {"store.json", "hierarchy.bin", "points.bin"}) {
    const std::size_t size = fs::file_size(sound_ / name);
    ASSERT_GT(size, kRegions);
    for (std::size_t region = 0; region < kRegions; ++region) {
      const std::size_t begin = size * region / kRegions;
      const std::size_t end = size * (region + 1) / kRegions;
      const std::size_t at = std::uniform_int_distribution<std::size_t>(begin, end - 1)(random);
      restore();
      flip(name, at, static_cast<int>(random() % 8));
      expectFound(name + " at byte " + std::to_string(at));
    }
  }
}

TEST_F(DamagedStore, TheFirstAndTheLastByteOfEveryFileCount) {
  for (const std::string name : {"store.json", "hierarchy.bin", "points.bin"})
    for (const std::size_t at : {std::size_t{0}, static_cast<std::size_t>(fs::file_size(sound_ / name)) - 1}) {
      restore();
      flip(name, at, 3);
      expectFound(name + " at byte " + std::to_string(at));
    }
}

TEST_F(DamagedStore, AFlippedBitInTheMiddleOfThePointsIsCountedAsOneBadNode) {
  flip("points.bin", fs::file_size(sound_ / "points.bin") / 2, 0);
  const Finished finished = verify();
  EXPECT_EQ(finished.exitCode, 1);
  const Json info = lastLine(finished);
  EXPECT_EQ(info.at("bad_nodes"), 1);
  EXPECT_EQ(info.at("checked_nodes"), info.at("nodes"));
}

TEST_F(DamagedStore, AFileCutShortIsFound) {
  for (const std::string name : {"store.json", "hierarchy.bin", "points.bin"})
    for (const double share : {0.0, 0.3, 0.999}) {
      restore();
      const auto size = static_cast<double>(fs::file_size(sound_ / name));
      fs::resize_file(damaged_ / name, static_cast<std::uintmax_t>(size * share));
      expectFound(name + " cut to " + std::to_string(share));
    }
}

TEST_F(DamagedStore, AFileThatGrewIsFound) {
  for (const std::string name : {"store.json", "hierarchy.bin", "points.bin"}) {
    restore();
    writeBytes(damaged_ / name, readWhole(sound_ / name) + "x");
    expectFound(name + " grew");
  }
}

TEST_F(DamagedStore, AMissingFileIsNamed) {
  for (const std::string name : {"store.json", "hierarchy.bin", "points.bin"}) {
    restore();
    fs::remove(damaged_ / name);
    const Finished finished = verify();
    expectFailure(finished);
    EXPECT_TRUE(mentions(finished, name)) << finished.err;
  }
}

TEST_F(DamagedStore, AStoreOfAnotherVersionIsRefusedByName) {
  Json info = Json::parse(readWhole(damaged_ / "store.json"));
  for (const int version : {1, 3}) {
    info["version"] = version;
    writeBytes(damaged_ / "store.json", info.dump());
    for (const std::string program : {"strata-info", "strata-export"}) {
      std::vector<std::string> arguments{damaged_.string()};
      if (program == "strata-export") arguments.insert(arguments.end(), {"-o", (folder_ / "out.las").string()});
      const Finished finished = runProgram(program, arguments);
      expectFailure(finished);
      EXPECT_TRUE(mentions(finished, "version")) << finished.err;
      EXPECT_TRUE(mentions(finished, "found " + std::to_string(version))) << finished.err;
      EXPECT_FALSE(fs::exists(folder_ / "out.las"));
    }
  }
}

TEST_F(DamagedStore, AnExportOfADamagedNodeFailsAndLeavesNoFile) {
  flip("points.bin", fs::file_size(sound_ / "points.bin") / 2, 0);
  for (const char* name : {"out.las", "out.laz", "out.ply"}) {
    expectFailure(runProgram("strata-export", {damaged_.string(), "-o", (folder_ / name).string()}));
    EXPECT_FALSE(fs::exists(folder_ / name));
  }
}

TEST_F(DamagedStore, AFolderOrAFileThatIsNoStoreIsRefused) {
  fs::create_directory(folder_ / "empty.strata");
  writeBytes(folder_ / "file.strata", "no store");
  for (const char* name : {"empty.strata", "file.strata", "missing.strata"}) {
    const Finished finished = runProgram("strata-info", {(folder_ / name).string()});
    expectFailure(finished);
    EXPECT_TRUE(mentions(finished, name)) << finished.err;
  }
}

}  // namespace
}  // namespace strata::test
