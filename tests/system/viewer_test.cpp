// strata-view in a virtual X server with software OpenGL, and what strata-bench leaves behind.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/image.h"
#include "tests/support/programs.h"

namespace strata::test {
namespace {

constexpr const char* kXvfbRun = "/usr/bin/xvfb-run";

class Viewer : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TempFolder;
    mustConvert({"synthetic:city?points=200000&seed=1"}, city());
    mustConvert({"synthetic:room?points=100000&seed=2"}, room());
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }
  static std::filesystem::path city() { return *folder_ / "city.strata"; }
  static std::filesystem::path room() { return *folder_ / "room.strata"; }
  static std::filesystem::path file(const std::string& name) { return *folder_ / name; }

  static Finished viewInX(const std::vector<std::string>& arguments) {
    std::vector<std::string> all{"-a", "-s", "-screen 0 1024x768x24", programPath("strata-view").string()};
    all.insert(all.end(), arguments.begin(), arguments.end());
    return runProgram(kXvfbRun, all);
  }

  static Finished bench(const std::string& out, const std::vector<std::string>& more) {
    std::vector<std::string> all{city().string(), "-o", file(out).string(), "--backend", "cpu", "--size", "160x90"};
    all.insert(all.end(), more.begin(), more.end());
    return runProgram("strata-bench", all);
  }

  static std::string shortPath() {
    const std::string path = file("short.json").string();
    const Finished made = runProgram("strata-bench", {"--make-path", "dive", city().string()});
    Json json = Json::parse(made.out);
    for (Json& key : json["keys"]) key["t"] = key["t"].get<double>() / 24.0;
    std::ofstream(path) << json;
    return path;
  }

 private:
  static TempFolder* folder_;
};
TempFolder* Viewer::folder_ = nullptr;

TEST_F(Viewer, WithoutADisplayItSaysSo) {
  unsetenv("DISPLAY");
  unsetenv("WAYLAND_DISPLAY");
  const Finished finished = runProgram("strata-view", {city().string(), "--screenshot", file("none.png").string()});
  expectFailure(finished);
  EXPECT_NE(finished.err.find("window"), std::string::npos) << finished.err;
}

TEST_F(Viewer, DrawsAStoreAndAPanel) {
  if (!std::filesystem::exists(kXvfbRun)) GTEST_SKIP() << "xvfb-run is not there";
  const std::string png = file("one.png").string();
  const Finished finished = viewInX({city().string(), "--backend", "cpu", "--size", "640x480", "--screenshot", png});
  ASSERT_EQ(finished.exitCode, 0) << finished.err;
  const Image image = readPng(png);
  ASSERT_EQ(image.width, 640);
  ASSERT_EQ(image.height, 480);
  EXPECT_GT(std::set<std::uint32_t>(image.pixels.begin(), image.pixels.end()).size(), 1000u);
}

TEST_F(Viewer, DrawsProgressivelyUntilThePictureIsWhole) {
  if (!std::filesystem::exists(kXvfbRun)) GTEST_SKIP() << "xvfb-run is not there";
  std::vector<Image> images;
  for (const std::vector<std::string>& way :
       {std::vector<std::string>{"--backend", "compute32"}, {"--progressive", "0.05"}}) {
    const std::string png = file("progressive.png").string();
    std::vector<std::string> arguments{city().string(), "--size", "640x480", "--screenshot", png};
    arguments.insert(arguments.end(), way.begin(), way.end());
    const Finished finished = viewInX(arguments);
    ASSERT_EQ(finished.exitCode, 0) << finished.err;
    images.push_back(readPng(png));
  }
  std::size_t different = 0;  // the panels lie left and right, the window of progressive drawing below
  for (int y = 0; y < 100; ++y)
    for (int x = 360; x < 400; ++x) {
      const auto at = static_cast<std::size_t>(y) * 640 + static_cast<std::size_t>(x);
      different += images[0].pixels[at] != images[1].pixels[at];
    }
  EXPECT_EQ(different, 0u);
}

TEST_F(Viewer, StillsAreTheSameDrawnProgressively) {
  const std::vector<std::string> common{city().string(), "--stills", "--size", "160x90"};
  for (const auto& [folder, way] : {std::pair<std::string, std::vector<std::string>>{"p1", {"--progressive", "0.02"}},
                                    {"p2", {"--backend", "compute32"}}}) {
    std::vector<std::string> all = common;
    all.insert(all.end(), way.begin(), way.end());
    all.insert(all.end(), {"-o", file(folder).string()});
    const Finished run = runProgram("strata-bench", all);
    if (run.exitCode != 0 && run.err.find("OpenGL") != std::string::npos) GTEST_SKIP() << run.err;
    ASSERT_EQ(run.exitCode, 0) << run.err;
  }
  for (const char* name : {"overview.png", "close.png", "detail.png"})
    EXPECT_EQ(readWhole(file("p1") / name), readWhole(file("p2") / name)) << name;
}

TEST_F(Viewer, ProgressiveDrawingRefusesWhatItDoesNotDo) {
  for (const std::vector<std::string>& wrong : std::vector<std::vector<std::string>>{{"--progressive", "1"},  // and cpu
                                                                                     {"--pool", "5"},
                                                                                     {"--progressive", "0"},
                                                                                     {"--progressive", "many"}}) {
    std::vector<std::string> all{"--stills"};
    all.insert(all.end(), wrong.begin(), wrong.end());
    const Finished run = bench("refused", all);
    EXPECT_EQ(run.exitCode, 2) << wrong.front();
    EXPECT_NE(run.err.find("error:"), std::string::npos);
  }
}

TEST_F(Viewer, DrawsSeveralStoresAsLayers) {
  if (!std::filesystem::exists(kXvfbRun)) GTEST_SKIP() << "xvfb-run is not there";
  const std::string png = file("two.png").string();
  const Finished finished = viewInX({city().string(), room().string(), "--size", "320x240", "--screenshot", png});
  ASSERT_EQ(finished.exitCode, 0) << finished.err;
  EXPECT_EQ(readPng(png).width, 320);
}

TEST_F(Viewer, AScreenshotThatCannotBeWrittenIsAnError) {
  if (!std::filesystem::exists(kXvfbRun)) GTEST_SKIP() << "xvfb-run is not there";
  EXPECT_EQ(viewInX({city().string(), "--size", "64x64", "--screenshot", "/nowhere/x.png"}).exitCode, 1);
}

TEST_F(Viewer, IsUsedByHandToPickMeasureOrbitClipFlyPhotographHideResizeSaveQuitAndReopen) {
  if (!std::filesystem::exists(kXvfbRun)) GTEST_SKIP() << "xvfb-run is not there";
  if (!std::filesystem::exists("/usr/bin/xdotool")) GTEST_SKIP() << "xdotool is not there";
  const std::filesystem::path folder = file("session");
  std::filesystem::create_directory(folder);
  const Finished session =
      runProgram(kXvfbRun, {"-a", "-s", "-screen 0 1024x768x24", STRATA_SOURCE_DIR "/tests/system/viewer_session.sh",
                            programPath("strata-view").string(), city().string(), folder.string()});
  ASSERT_EQ(session.exitCode, 0) << session.err;
  const auto step = [&](const std::string& name) { return Json::parse(readWhole(folder / (name + ".project.json"))); };
  EXPECT_TRUE(step("start").at("measurements").empty());
  const Json measured = step("measured").at("measurements");
  ASSERT_GE(measured.size(), 1u);
  ASSERT_EQ(measured[0].at("points").size(), 2u);
  // Points of the scan, not of the screen: on its grid of millimetres, to the last digit.
  for (const Json& point : measured[0].at("points"))
    for (const Json& coordinate : point) {
      const double steps = coordinate.get<double>() * 1000.0;
      EXPECT_NEAR(steps, std::round(steps), 1e-4);
    }
  EXPECT_NE(step("start").at("camera").at("eye"), step("orbited").at("camera").at("eye"));
  EXPECT_EQ(step("resized").at("measurements"), measured);
  EXPECT_GE(step("clipped").at("clip_boxes").size(), 1u);
  EXPECT_EQ(step("start").at("clip_boxes").size(), 0u);

  // The picture: of the size asked for, with the scan in its middle and background around it.
  const Image picture = readPng(folder / "city.png");
  ASSERT_EQ(picture.width, 4096);
  ASSERT_EQ(picture.height, 2560);
  const auto background = std::count(picture.pixels.begin(), picture.pixels.end(), picture.pixels.front());
  EXPECT_GT(static_cast<double>(background), 0.1 * 4096 * 2560);
  EXPECT_LT(static_cast<double>(background), 0.99 * 4096 * 2560);

  // The camera path is one that strata-bench plays.
  const Json path = Json::parse(readWhole(folder / "city.path.json"));
  ASSERT_GE(path.at("keys").size(), 2u);
  EXPECT_NE(path.at("keys")[0].at("eye"), path.at("keys")[1].at("eye"));
  EXPECT_EQ(path.at("keys")[0].at("t"), 0.0);
  const Finished played =
      bench("played", {"--path", (folder / "city.path.json").string(), "--settle", "--screenshot-every", "1000"});
  EXPECT_EQ(played.exitCode, 0) << played.err;

  // Hundredths of a second of CPU time in two seconds of drawing every frame, and of a window that is not seen.
  const auto ticks = [&](const char* name) { return std::stol(readWhole(folder / name)); };
  EXPECT_GT(ticks("ticks_shown"), 20);
  EXPECT_LE(ticks("ticks_hidden"), 4);
  EXPECT_GT(ticks("ticks_shown_again"), 20);

  // Reopened, the measurement is drawn where it was made.
  const std::string png = file("reopened.png").string();
  const Finished reopened = viewInX(
      {(folder / "resized.project.json").string(), "--backend", "cpu", "--size", "800x600", "--screenshot", png});
  ASSERT_EQ(reopened.exitCode, 0) << reopened.err;
  const Image image = readPng(png);
  const auto yellow = std::count_if(image.pixels.begin(), image.pixels.end(), [](std::uint32_t pixel) {
    return (pixel & 0xff) > 240 && (pixel >> 8 & 0xff) > 180 && (pixel >> 8 & 0xff) < 210 && (pixel >> 16 & 0xff) < 20;
  });
  EXPECT_GT(yellow, 20);
}

TEST_F(Viewer, WritesAPictureOfAnySizeWithoutPanels) {
  if (!std::filesystem::exists(kXvfbRun)) GTEST_SKIP() << "xvfb-run is not there";
  const std::string png = file("large.png").string();
  const Finished finished = viewInX(
      {city().string(), "--backend", "cpu", "--size", "640x400", "--picture", png, "--picture-size", "3000x1200"});
  ASSERT_EQ(finished.exitCode, 0) << finished.err;
  const Image image = readPng(png);
  EXPECT_EQ(image.width, 3000);
  EXPECT_EQ(image.height, 1200);
  EXPECT_GT(std::set<std::uint32_t>(image.pixels.begin(), image.pixels.end()).size(), 1000u);
  EXPECT_EQ(viewInX({city().string(), "--picture", "/nowhere/x.png"}).exitCode, 1);
  EXPECT_EQ(viewInX({city().string(), "--picture", png, "--picture-size", "20000x10"}).exitCode, 2);
}

TEST_F(Viewer, ConvertsAScanBesideItselfAndOpensItAndTheNextTimeOpensThatStore) {
  if (!std::filesystem::exists(kXvfbRun)) GTEST_SKIP() << "xvfb-run is not there";
  const std::string scan = file("walls.ply").string();
  ASSERT_EQ(runProgram("strata-export", {room().string(), "-o", scan}).exitCode, 0);
  for (const char* png : {"first.png", "second.png"}) {
    const Finished finished =
        viewInX({scan, "--convert", "--backend", "cpu", "--size", "320x240", "--screenshot", file(png).string()});
    ASSERT_EQ(finished.exitCode, 0) << finished.err;
    EXPECT_TRUE(std::filesystem::exists(file("walls.strata") / "store.json"));
    EXPECT_EQ(readPng(file(png).string()).width, 320);
  }
}

TEST_F(Viewer, AScanThatCannotBeConvertedIsRefusedInOneLine) {
  if (!std::filesystem::exists(kXvfbRun)) GTEST_SKIP() << "xvfb-run is not there";
  std::ofstream(file("broken.las")) << "this is no LAS file";
  const Finished finished =
      viewInX({file("broken.las").string(), "--convert", "--screenshot", file("broken.png").string()});
  EXPECT_EQ(finished.exitCode, 1);
  EXPECT_NE(finished.err.find("broken.las"), std::string::npos) << finished.err;
  EXPECT_FALSE(std::filesystem::exists(file("broken.strata")));
}

TEST_F(Viewer, RefusesAProjectThatIsNoneInOneLine) {
  std::ofstream(file("not.json")) << "{}";
  const Finished finished = viewInX({file("not.json").string(), "--screenshot", file("not.png").string()});
  EXPECT_EQ(finished.exitCode, 1);
  EXPECT_NE(finished.err.find("is no project of strata-view"), std::string::npos) << finished.err;
}

TEST_F(Viewer, ARunComparedWithItselfIsNotWorseAndWithASlowedOneIs) {
  const Finished run = bench("a", {"--path", shortPath(), "--settle", "--json"});
  ASSERT_EQ(run.exitCode, 0) << run.err;
  EXPECT_EQ(linesOf(run.out).size(), 1u);
  const std::string a = file("a").string();
  EXPECT_EQ(runProgram("strata-bench", {"compare", a, a, "--fail-above", "0%"}).exitCode, 0);
  Json report = Json::parse(readWhole(file("a") / "report.json"));
  report["measures"]["frame_ms"]["p50"] = report["measures"]["frame_ms"]["p50"].get<double>() * 1.5;
  std::ofstream(file("slow.json")) << report;
  const std::string slow = file("slow.json").string();
  EXPECT_EQ(runProgram("strata-bench", {"compare", a, slow, "--fail-above", "20%"}).exitCode, 1);
  EXPECT_EQ(runProgram("strata-bench", {"compare", a, slow}).exitCode, 0);
  EXPECT_EQ(runProgram("strata-bench", {"compare", a, slow, "--fail-above", "much"}).exitCode, 2);
  EXPECT_EQ(runProgram("strata-bench", {"compare", a}).exitCode, 2);
}

TEST_F(Viewer, WritesEveryNthFrameAndALineForEach) {
  const Finished run = bench("frames", {"--path", shortPath(), "--settle", "--screenshot-every", "5"});
  ASSERT_EQ(run.exitCode, 0) << run.err;
  const std::vector<std::string> lines = linesOf(readWhole(file("frames") / "frames.csv"));
  std::size_t pictures = 0;
  for (const auto& entry : std::filesystem::directory_iterator(file("frames")))
    pictures += entry.path().extension() == ".png" ? 1 : 0;
  EXPECT_EQ(pictures, (lines.size() - 2) / 5 + 1);
}

TEST_F(Viewer, StillsAreTheSameInEveryRun) {
  ASSERT_EQ(bench("s1", {"--stills"}).exitCode, 0);
  ASSERT_EQ(bench("s2", {"--stills"}).exitCode, 0);
  for (const char* name : {"overview.png", "close.png", "detail.png"})
    EXPECT_EQ(readWhole(file("s1") / name), readWhole(file("s2") / name)) << name;
}

TEST_F(Viewer, AFolderThatCannotBeMadeIsAnError) {
  std::ofstream(file("plain")) << "x";
  expectFailure(bench("plain/below", {"--stills"}));
}

TEST_F(Viewer, EveryKindOfPathCanBePlayed) {
  for (const char* kind : {"orbit", "flythrough", "dive", "street"})
    for (const auto& store : {city(), room()}) {
      const Finished made = runProgram("strata-bench", {"--make-path", kind, store.string()});
      ASSERT_EQ(made.exitCode, 0) << made.err;
      const Json json = Json::parse(made.out);
      EXPECT_GE(json["keys"].size(), 2u);
      EXPECT_EQ(json["fov_y"].get<double>(), std::round(json["fov_y"].get<double>()));
    }
}

}  // namespace
}  // namespace strata::test
