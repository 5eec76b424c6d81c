// strata-view in a virtual X server with software OpenGL, and the flights and stills of strata-bench.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/image.h"
#include "tests/support/viewer_hand.h"

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
    std::vector<std::string> all{"-a", "-s", "-screen 0 1024x768x24 -noreset", programPath("strata-view").string()};
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
    std::vector<std::string> arguments{city().string(), "--size", "1200x800", "--screenshot", png};
    arguments.insert(arguments.end(), way.begin(), way.end());
    const Finished finished = viewInX(arguments);
    ASSERT_EQ(finished.exitCode, 0) << finished.err;
    images.push_back(readPng(png));
  }
  std::size_t different = 0;  // between the panels, which lie left and right
  for (int y = 0; y < 800; ++y)
    for (int x = 370; x < 840; ++x) {
      const auto at = static_cast<std::size_t>(y) * 1200 + static_cast<std::size_t>(x);
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

TEST_F(Viewer, PicksMeasuresOrbitsClipsRecordsTakesPicturesHidesResizesSavesQuitsAndReopens) {
  if (!ViewerHand::possible()) GTEST_SKIP() << "Xvfb or xdotool is not there";
  const std::filesystem::path folder = file("session");
  std::filesystem::create_directory(folder);
  ViewerHand hand(folder, {city().string(), "--backend", "cpu", "--size", "800x600"});
  const std::string saved = "city.project.json";
  const Json start = hand.save(saved);
  EXPECT_TRUE(start.at("measurements").empty());
  EXPECT_TRUE(start.at("clip_boxes").empty());

  hand.key("m");
  hand.click(380, 330);
  hand.until("measuring", 1);
  hand.click(450, 380);
  hand.until("measured", 1);
  hand.key("Return");
  const Json measured = hand.save(saved).at("measurements");
  ASSERT_EQ(measured.size(), 1u);
  EXPECT_EQ(measured[0].at("kind"), "distance");
  ASSERT_EQ(measured[0].at("points").size(), 2u);
  // The points are those of the scan: they lie on its grid of millimetres, to the last digit.
  for (const Json& point : measured[0].at("points"))
    for (const Json& coordinate : point) {
      const double steps = coordinate.get<double>() * 1000.0;
      EXPECT_NEAR(steps, std::round(steps), 1e-4);
    }

  hand.drag(400, 350, 520, 340);
  EXPECT_NE(start.at("camera").at("eye"), hand.save(saved).at("camera").at("eye"));
  hand.key("b");
  EXPECT_EQ(hand.save(saved).at("clip_boxes").size(), 1u);
  hand.key("k");
  hand.drag(400, 380, 520, 370);
  hand.key("k");
  hand.until("path_keys", 2);
  hand.save(saved);  // which writes the camera path too

  hand.key("ctrl+p");
  hand.until("working", true);
  hand.until("working", false);
  EXPECT_EQ(hand.state().at("error"), "");

  // While a path is being recorded every frame is drawn, but not in a window that is hidden.
  const auto drawn = [&hand] { return hand.state().at("drawn").get<int>(); };
  hand.key("r");
  hand.until("recording", true);
  const int atFirst = drawn();
  hand.frames(6);
  EXPECT_GE(drawn(), atFirst + 6);
  hand.hide();
  const int whenHidden = drawn();
  const long ticks = hand.cpuTicks();
  hand.frames(8);
  EXPECT_EQ(drawn(), whenHidden);
  EXPECT_LE(hand.cpuTicks(), ticks + 6);  // hundredths of a second of CPU time, in two seconds
  hand.show();
  hand.until("a frame to be drawn", [&](const Json& s) { return s.at("drawn").get<int>() > whenHidden; });
  hand.key("r");
  hand.until("recording", false);
  hand.resize(640, 700);
  EXPECT_EQ(hand.save(saved).at("measurements"), measured);
  EXPECT_EQ(hand.quit(), 0) << hand.said();

  // The picture has the size that was asked for, with the scan in the middle and background around it.
  const Image picture = readPng(folder / "city.png");
  ASSERT_EQ(picture.width, 4096);
  ASSERT_EQ(picture.height, 2560);
  const auto background = std::count(picture.pixels.begin(), picture.pixels.end(), picture.pixels.front());
  EXPECT_GT(static_cast<double>(background), 0.1 * 4096 * 2560);
  EXPECT_LT(static_cast<double>(background), 0.99 * 4096 * 2560);

  // strata-bench can play the camera path.
  const Json path = Json::parse(readWhole(folder / "city.path.json"));
  ASSERT_GE(path.at("keys").size(), 2u);
  EXPECT_NE(path.at("keys")[0].at("eye"), path.at("keys")[1].at("eye"));
  EXPECT_EQ(path.at("keys")[0].at("t"), 0.0);
  const Finished played =
      bench("played", {"--path", (folder / "city.path.json").string(), "--settle", "--screenshot-every", "1000"});
  EXPECT_EQ(played.exitCode, 0) << played.err;

  // The measurement is drawn again when the project is reopened.
  const std::string png = file("reopened.png").string();
  const Finished reopened =
      viewInX({(folder / saved).string(), "--backend", "cpu", "--size", "800x600", "--screenshot", png});
  ASSERT_EQ(reopened.exitCode, 0) << reopened.err;
  const Image image = readPng(png);
  const auto yellow = std::count_if(image.pixels.begin(), image.pixels.end(), [](std::uint32_t pixel) {
    return (pixel & 0xff) > 240 && (pixel >> 8 & 0xff) > 180 && (pixel >> 8 & 0xff) < 210 && (pixel >> 16 & 0xff) < 20;
  });
  EXPECT_GT(yellow, 20);
}

/// Two keys of a camera path and the window that makes films, open at its film.
void openTheFilm(ViewerHand& hand) {
  hand.key("k");
  hand.drag(400, 350, 480, 350);
  hand.key("k");
  hand.until("path_keys", 2);
  hand.key("p");
  hand.clickItem("Film of the path");
  for (const auto& [item, value] : {std::pair{"film size width", "322"}, std::pair{"film size height", "181"}}) {
    hand.clickItem(item);
    hand.key("ctrl+a");
    hand.write(value);
    hand.key("Return");
  }
}

TEST_F(Viewer, MakesAFilmOfTwoKeysSetByHand) {
  if (!ViewerHand::possible()) GTEST_SKIP() << "Xvfb or xdotool is not there";
  for (const char* program : {"/usr/bin/ffmpeg", "/usr/bin/ffprobe"})
    if (!std::filesystem::exists(program)) GTEST_SKIP() << program << " is not there";
  const std::filesystem::path folder = file("film");
  std::filesystem::create_directory(folder);
  ViewerHand hand(folder, {city().string(), "--backend", "cpu", "--size", "800x700"});
  openTheFilm(hand);
  hand.clickItem("make the film");
  hand.until("the film", [](const Json& s) {
    return s.at("notice").get<std::string>().starts_with("saved city.mp4") || s.at("error") != "";
  });
  EXPECT_EQ(hand.state().at("error"), "");
  EXPECT_EQ(hand.quit(), 0) << hand.said();

  const Finished probed =
      runProgram("/usr/bin/ffprobe",
                 {"-v", "error", "-count_frames", "-select_streams", "v:0", "-show_entries",
                  "stream=width,height,nb_read_frames,r_frame_rate", "-of", "json", (folder / "city.mp4").string()});
  ASSERT_EQ(probed.exitCode, 0) << probed.err;
  const Json stream = Json::parse(probed.out).at("streams").at(0);
  EXPECT_EQ(stream.at("width"), 322);
  EXPECT_EQ(stream.at("height"), 182);  // an odd row is padded
  EXPECT_EQ(stream.at("nb_read_frames"), "61");
  EXPECT_EQ(stream.at("r_frame_rate"), "30/1");
  EXPECT_FALSE(std::filesystem::exists(folder / "city.part.mp4"));
}

TEST_F(Viewer, AFilmThatCannotBeMadeIsReportedAndTheFilmBeforeItStays) {
  if (!ViewerHand::possible()) GTEST_SKIP() << "Xvfb or xdotool is not there";
  const std::filesystem::path folder = file("no_film"), programs = folder / "programs";
  std::filesystem::create_directories(programs);
  std::ofstream(folder / "city.mp4") << "an older film";
  ViewerHand hand(folder, {city().string(), "--backend", "cpu", "--size", "800x700"},
                  {.environment = {{"PATH", programs.string()}}});
  openTheFilm(hand);
  const auto failure = [&hand] {
    hand.clickItem("make the film");
    hand.until("a message", [](const Json& s) { return s.at("error") != "" && !s.at("working").get<bool>(); });
    return hand.frames(3).at("error").get<std::string>();
  };
  EXPECT_NE(failure().find("ffmpeg, which is not installed"), std::string::npos) << hand.state();
  hand.clickItem("close the message");
  hand.until("error", "");

  // This ffmpeg fails as the real one does when the disk is full.
  std::ofstream(programs / "ffmpeg") << "#!/bin/sh\nread -r line\necho 'No space left on device' >&2\nexit 1\n";
  std::filesystem::permissions(programs / "ffmpeg", std::filesystem::perms::owner_all);
  EXPECT_NE(failure().find("No space left on device"), std::string::npos) << hand.state();
  EXPECT_EQ(readWhole(folder / "city.mp4"), "an older film");
  EXPECT_EQ(hand.quit(), 0) << hand.said();
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

TEST_F(Viewer, ANewUserGetsFromAScanToAMeasuredDistance) {
  if (!ViewerHand::possible()) GTEST_SKIP() << "Xvfb or xdotool is not there";
  const std::filesystem::path folder = file("first");
  std::filesystem::create_directory(folder);
  ASSERT_EQ(runProgram("strata-export", {city().string(), "-o", (folder / "scan.laz").string()}).exitCode, 0);
  // Something that is no store lies where the store belongs. The window says so, and the user can remove it and go on.
  std::ofstream(folder / "scan.strata") << "no store";
  ViewerHand hand(folder, {(folder / "scan.laz").string(), "--backend", "cpu", "--size", "800x600"});
  hand.clickItem("convert");
  hand.until("a message", [](const Json& s) { return s.at("error") != ""; });
  EXPECT_NE(hand.frames(3).at("error").get<std::string>().find("scan.strata"), std::string::npos) << hand.state();
  std::filesystem::remove(folder / "scan.strata");
  hand.clickItem("convert");
  hand.turnToScene();
  hand.key("m");
  hand.click(380, 330);
  hand.until("measuring", 1);
  hand.click(450, 380);
  hand.until("measured", 1);
  EXPECT_EQ(hand.quit(), 0) << hand.said();
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

TEST_F(Viewer, RefusesAFileThatIsNoProjectInOneLine) {
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
  const auto slowDown = [](Json& measures) {
    measures["frame_ms"]["p50"] = measures["frame_ms"]["p50"].get<double>() * 1.5;
  };
  slowDown(report["measures"]);
  for (Json& repetition : report["runs"]) slowDown(repetition);
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
