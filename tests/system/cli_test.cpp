// The command line is a contract: options, exit codes, and the output of --json.
#include <algorithm>

#include "core/image.h"
#include "tests/support/programs.h"

namespace strata::test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPrograms[] = {"strata-convert", "strata-info", "strata-export", "strata-bench", "strata-view"};

void expectKeys(const Json& object, const std::vector<std::string>& keys) {
  for (const std::string& key : keys) EXPECT_TRUE(object.contains(key)) << key << " is not in " << object.dump();
}

TEST(Programs, HelpGoesToStdoutAndExitsWithZero) {
  for (const char* program : kPrograms) {
    const Finished finished = runProgram(program, {"--help"});
    EXPECT_EQ(finished.exitCode, 0) << program;
    EXPECT_FALSE(finished.out.empty()) << program;
    EXPECT_EQ(finished.err, "") << program;
  }
}

TEST(Programs, HelpIsTextThatATerminalCanShow) {
  for (const char* program : kPrograms)
    for (const unsigned char byte : runProgram(program, {"--help"}).out)
      ASSERT_TRUE(byte == '\n' || (byte >= 0x20 && byte < 0x7f)) << program << " prints byte " << int{byte};
}

TEST(Programs, AnUnknownOptionIsWrongUsage) {
  for (const char* program : kPrograms) expectUsageError(runProgram(program, {"--no-such-option"}));
}

TEST(Programs, NoArgumentsIsWrongUsage) {
  for (const char* program : kPrograms) expectUsageError(runProgram(program, {}));
}

TEST(Programs, AnOptionWithABadValueIsWrongUsage) {
  const TempFolder folder;
  const std::string store = (folder / "out.strata").string();
  const std::vector<std::vector<std::string>> wrong{
      {"--memory", "lots"}, {"--memory", "-1"},     {"--memory", "0"},      {"--threads", "two"},
      {"--threads", "-3"},  {"--node-points", "0"}, {"--node-points", "x"}, {"--threads", "1.5"},
  };
  for (const std::vector<std::string>& options : wrong) {
    SCOPED_TRACE(options[0] + " " + options[1]);
    expectUsageError(convert({"synthetic:plane?points=10"}, store, options));
    EXPECT_FALSE(fs::exists(store));
  }
}

TEST(Programs, ASyntheticScanThatDoesNotExistIsNamed) {
  const TempFolder folder;
  for (const char* input : {"synthetic:", "synthetic:castle?points=10", "synthetic:plane?points=many",
                            "synthetic:plane?colour=red", "synthetic:plane?points=0", "synthetic:plane?points=-5"}) {
    SCOPED_TRACE(input);
    const Finished finished = convert({input}, folder / "out.strata");
    EXPECT_NE(finished.exitCode, 0);
    EXPECT_LE(finished.exitCode, 2);
    EXPECT_EQ(finished.err.rfind("error: ", 0), 0u) << finished.err;
    EXPECT_EQ(linesOf(finished.err).size(), 1u) << finished.err;
    EXPECT_FALSE(fs::exists(folder / "out.strata"));
  }
}

/// A store of the synthetic room, converted once for all tests.
class RoomStore : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TempFolder;
    converted_ = convert({"synthetic:room?points=50000"}, store(), {"--node-points", "5000"});
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }
  static fs::path store() { return *folder_ / "room.strata"; }

  static inline TempFolder* folder_ = nullptr;
  static inline Finished converted_;
};

TEST_F(RoomStore, ConvertPrintsWhatItDidAsOneJsonObject) {
  ASSERT_EQ(converted_.exitCode, 0) << converted_.err;
  const Json result = lastLine(converted_);
  expectKeys(result, {"points", "nodes", "seconds", "points_per_second", "cpu_seconds", "peak_rss_bytes", "input_bytes",
                      "output_bytes", "temp_peak_bytes", "skipped"});
  EXPECT_EQ(result.at("points"), 50000);
  EXPECT_EQ(result.at("skipped"), 0);
  EXPECT_GT(result.at("nodes"), 1);
  std::uintmax_t bytes = 0;
  for (const char* name : {"store.json", "hierarchy.bin", "points.bin"}) bytes += fs::file_size(store() / name);
  EXPECT_EQ(result.at("output_bytes"), bytes);
  EXPECT_GT(result.at("seconds"), 0.0);
  EXPECT_GT(result.at("peak_rss_bytes"), 1 << 20);
}

TEST_F(RoomStore, AStoreIsThreeFilesAndNothingBesideIt) {
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(store()))
    names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  EXPECT_EQ(names, (std::vector<std::string>{"hierarchy.bin", "points.bin", "store.json"}));
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_->path()))
    EXPECT_EQ(entry.path().filename(), "room.strata") << "left behind by the conversion";
}

TEST_F(RoomStore, InfoPrintsWhatIsInTheStore) {
  const Json info = mustInfo(store());
  expectKeys(info, {"points", "nodes", "bounds", "levels", "attributes", "crs"});
  EXPECT_EQ(info.at("points"), 50000);
  EXPECT_EQ(info.at("nodes"), lastLine(converted_).at("nodes"));
  const Finished text = runProgram("strata-info", {store().string()});
  EXPECT_EQ(text.exitCode, 0);
  EXPECT_NE(text.out.find("50000"), std::string::npos) << text.out;
}

TEST_F(RoomStore, VerifyChecksEveryNode) {
  const Json info = mustInfo(store(), true);
  expectKeys(info, {"checked_nodes", "bad_nodes"});
  EXPECT_EQ(info.at("checked_nodes"), info.at("nodes"));
  EXPECT_EQ(info.at("bad_nodes"), 0);
}

TEST_F(RoomStore, AnExportHoldsEveryPoint) {
  EXPECT_EQ(mustExport(store(), *folder_ / "all.las").count, 50000u);
  for (const char* name : {"all.laz", "all.ply"}) {
    const std::string path = (*folder_ / name).string();
    ASSERT_EQ(runProgram("strata-export", {store().string(), "-o", path}).exitCode, 0);
    EXPECT_EQ(mustConvert({path}, path + ".strata").at("points"), 50000) << name;
    fs::remove_all(path + ".strata");
    fs::remove(path);
  }
  fs::remove(*folder_ / "all.las");
}

TEST_F(RoomStore, AnExportOfABoxHoldsExactlyThePointsInIt) {
  const std::string all = (*folder_ / "all.las").string();
  const LasFile whole = mustExport(store(), all);
  const Json bounds = mustInfo(store()).at("bounds");
  std::array<double, 3> low{}, high{};
  for (std::size_t axis = 0; axis < 3; ++axis) {  // a box off the grid, so that no point lies on its faces
    const double a = bounds.at("min").at(axis), b = bounds.at("max").at(axis);
    low[axis] = a + 0.2137 * (b - a);
    high[axis] = a + 0.8391 * (b - a);
  }
  std::uint64_t inside = 0;
  for (std::uint64_t i = 0; i < whole.count; ++i) {
    const auto at = whole.position(i);
    inside += at[0] >= low[0] && at[0] <= high[0] && at[1] >= low[1] && at[1] <= high[1] && at[2] >= low[2] &&
              at[2] <= high[2];
  }
  std::vector<std::string> arguments{store().string(), "-o", (*folder_ / "box.las").string(), "--box"};
  for (const auto& corner : {low, high})
    for (const double value : corner) arguments.push_back(std::to_string(value));
  ASSERT_EQ(runProgram("strata-export", arguments).exitCode, 0);
  EXPECT_NEAR(static_cast<double>(readLas(*folder_ / "box.las").count), static_cast<double>(inside), 2.0);
  fs::remove(*folder_ / "box.las");
  fs::remove(all);
}

TEST_F(RoomStore, AnExportOfALevelHoldsFewerPointsTheHigherTheLevel) {
  const int levels = mustInfo(store()).at("levels");
  ASSERT_GT(levels, 1);
  std::uint64_t before = 0;
  for (int level = 0; level < levels; ++level) {
    const std::string path = (*folder_ / "level.las").string();
    ASSERT_EQ(runProgram("strata-export", {store().string(), "-o", path, "--level", std::to_string(level)}).exitCode,
              0);
    const std::uint64_t count = readLas(path).count;
    EXPECT_GT(count, before);
    before = count;
    fs::remove(path);
  }
  EXPECT_EQ(before, 50000u);
}

TEST_F(RoomStore, AnExportWithABadEndingBoxOrLevelIsRefused) {
  expectUsageError(runProgram("strata-export", {store().string(), "-o", (*folder_ / "out.docx").string()}));
  expectUsageError(
      runProgram("strata-export", {store().string(), "-o", (*folder_ / "out.las").string(), "--box", "1", "2"}));
  expectUsageError(
      runProgram("strata-export", {store().string(), "-o", (*folder_ / "out.las").string(), "--level", "x"}));
  EXPECT_FALSE(fs::exists(*folder_ / "out.las"));
}

TEST_F(RoomStore, AnyNumberOfThreadsGivesTheSameBytes) {
  for (const char* threads : {"1", "2", "7"}) {
    const fs::path other = *folder_ / (std::string("t") + threads + ".strata");
    mustConvert({"synthetic:room?points=50000"}, other, {"--node-points", "5000", "--threads", threads});
    for (const char* name : {"hierarchy.bin", "points.bin", "store.json"})
      EXPECT_TRUE(readWhole(other / name) == readWhole(store() / name)) << name << " with " << threads << " threads";
    fs::remove_all(other);
  }
}

TEST_F(RoomStore, SeveralFilesAndAFolderOfThemAreOneCloud) {
  const fs::path tiles = *folder_ / "tiles";
  fs::create_directories(tiles / "deeper");
  LasSpec spec;
  spec.points = gridPoints(20);
  writeLas(tiles / "a.las", spec);
  spec.offset = {100.0, 0.0, 0.0};
  writeLas(tiles / "deeper" / "b.LAS", spec);
  writeBytes(tiles / "notes.docx", "no scan");
  const fs::path one = *folder_ / "one.strata", two = *folder_ / "two.strata";
  EXPECT_EQ(mustConvert({tiles.string()}, one).at("points"), 800);
  EXPECT_EQ(mustConvert({(tiles / "a.las").string(), (tiles / "deeper" / "b.LAS").string()}, two).at("points"), 800);
  EXPECT_TRUE(readWhole(one / "points.bin") == readWhole(two / "points.bin"));
  for (const fs::path& made : {tiles, one, two}) fs::remove_all(made);
}

/// Expects a picture that shows something besides the background.
void expectPicture(const fs::path& path) {
  ASSERT_TRUE(fs::exists(path)) << path;
  const Image image = readPng(path.string());
  const std::uint32_t corner = image.pixels.at(0);
  const auto other =
      std::count_if(image.pixels.begin(), image.pixels.end(), [corner](std::uint32_t p) { return p != corner; });
  EXPECT_GT(other, image.width * image.height / 100) << path << " is empty";
}

TEST_F(RoomStore, ABenchFliesItsPathAndLeavesPicturesAndAReport) {
  const Finished path = runProgram("strata-bench", {"--make-path", "orbit", store().string()});
  ASSERT_EQ(path.exitCode, 0) << path.err;
  Json orbit = Json::parse(path.out);
  expectKeys(orbit, {"fps", "fov_y", "keys"});
  orbit["fps"] = 2;
  const fs::path out = *folder_ / "bench";
  fs::create_directory(out);
  writeBytes(out / "path.json", orbit.dump());
  const Finished bench =
      runProgram("strata-bench", {store().string(), "--path", (out / "path.json").string(), "-o", out.string(),
                                  "--backend", "cpu", "--size", "320x180", "--screenshot-every", "5", "--json"});
  ASSERT_EQ(bench.exitCode, 0) << bench.err;
  const Json result = lastLine(bench);
  expectKeys(result, {"frames", "frame_ms", "points_per_second", "points_drawn_mean", "time_to_full_detail_ms",
                      "lod_ms", "bytes_read", "cache_hit_rate", "hitches", "backend", "device"});
  expectKeys(result.at("frame_ms"), {"p50", "p95", "p99", "max"});
  EXPECT_EQ(result.at("backend"), "cpu");
  EXPECT_TRUE(Json::accept(readWhole(out / "report.json")));
  EXPECT_NE(readWhole(out / "report.html").find("</html>"), std::string::npos);
  int pictures = 0;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(out))
    pictures += entry.path().extension() == ".png";
  EXPECT_GT(pictures, 0);
}

TEST_F(RoomStore, StillsAreThreePictures) {
  const fs::path out = *folder_ / "stills";
  const Finished stills = runProgram(
      "strata-bench", {store().string(), "--stills", "-o", out.string(), "--backend", "cpu", "--size", "320x180"});
  ASSERT_EQ(stills.exitCode, 0) << stills.err;
  for (const char* name : {"overview.png", "close.png", "detail.png"}) expectPicture(out / name);
}

TEST_F(RoomStore, ARepeatedFlightHasMarkedPicturesJumpsAndNoiseAndEqualsItself) {
  const fs::path out = *folder_ / "repeated";
  fs::create_directory(out);
  writeBytes(
      out / "path.json",
      R"({"fps":10,"speed":"constant","keys":[)"
      R"({"t":0,"eye":[1,1,1],"target":[3,3,1]},{"t":1,"eye":[2,1,1],"target":[3,3,1],"mark":true},)"
      R"({"t":1.5,"eye":[2,3,2],"target":[0,0,0],"cut":true,"mark":true},{"t":2,"eye":[3,3,2],"target":[0,0,0]}]})");
  for (const char* run : {"a", "b"}) {
    const Finished bench = runProgram(
        "strata-bench", {store().string(), "--path", (out / "path.json").string(), "-o", (out / run).string(),
                         "--backend", "cpu", "--size", "160x90", "--repeat", "3", "--settle"});
    ASSERT_EQ(bench.exitCode, 0) << bench.err;
  }
  const Json report = Json::parse(readWhole(out / "a/report.json"));
  EXPECT_EQ(report.at("runs").size(), 3u);
  EXPECT_EQ(report.at("jumps").size(), 2u);
  EXPECT_TRUE(report.at("jumps")[1].at("reached_ms").at("100").is_number());
  EXPECT_TRUE(report.at("noise").contains("frame_ms p50"));
  ASSERT_EQ(report.at("pictures").size(), 2u);
  const Json other = Json::parse(readWhole(out / "b/report.json"));
  EXPECT_EQ(report.at("pictures"), other.at("pictures")) << "a settled flight gives other pictures each time";
  EXPECT_EQ(report.at("store").at("hash"), other.at("store").at("hash"));
  const Finished compared = runProgram(
      "strata-bench", {"compare", (out / "a").string(), (out / "b").string(), "-o", (out / "compare.html").string()});
  EXPECT_EQ(compared.exitCode, 0) << compared.err;
  EXPECT_NE(compared.out.find("frame_00010.png: equal"), std::string::npos) << compared.out;
  EXPECT_NE(readWhole(out / "compare.html").find("</html>"), std::string::npos);
}

TEST_F(RoomStore, AFilmIsTakenWhereFfmpegIsInstalledAndRefusedInOneLineElsewhere) {
  const fs::path out = *folder_ / "film";
  fs::create_directory(out);
  writeBytes(out / "path.json",
             R"({"fps":10,"keys":[{"t":0,"eye":[1,1,1],"target":[3,3,1]},{"t":0.5,"eye":[2,1,1],"target":[3,3,1]}]})");
  const Finished bench =
      runProgram("strata-bench", {store().string(), "--path", (out / "path.json").string(), "-o", out.string(),
                                  "--backend", "cpu", "--size", "161x91", "--video", (out / "flight.mp4").string()});
  if (bench.exitCode == 0) {
    EXPECT_GT(fs::file_size(out / "flight.mp4"), 500u);
  } else {
    EXPECT_NE(bench.err.find("ffmpeg, which is not installed"), std::string::npos) << bench.err;
  }
}

TEST_F(RoomStore, ABenchRefusesWhatItCannotPlay) {
  const std::string out = (*folder_ / "refused").string();
  writeBytes(*folder_ / "path.json", "{\"fps\":30}");
  expectFailure(runProgram("strata-bench", {store().string(), "--path", (*folder_ / "path.json").string(), "-o", out}));
  expectFailure(
      runProgram("strata-bench", {store().string(), "--path", (*folder_ / "missing.json").string(), "-o", out}));
  expectUsageError(runProgram("strata-bench", {"--make-path", "spiral", store().string()}));
  expectUsageError(runProgram("strata-bench", {store().string(), "--stills", "-o", out, "--backend", "abacus"}));
  expectUsageError(runProgram("strata-bench", {store().string(), "--stills", "-o", out, "--size", "big"}));
}

}  // namespace
}  // namespace strata::test
