// The tools of strata-view used by hand in a virtual X server: clip boxes, classes, profiles, stores that are damaged.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/image.h"
#include "tests/support/programs.h"
#include "viewer/camera_control.h"
#include "viewer/project.h"

namespace strata::test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kXvfbRun = "/usr/bin/xvfb-run";
constexpr int kWidth = 1000, kHeight = 700;
// Between the panels at the window's sides.
constexpr int kLeft = 370, kRight = 650, kUpper = 40, kLower = 660;

class ViewerTools : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TempFolder;
    mustConvert({"synthetic:city?points=200000&seed=1"}, store());
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }
  void SetUp() override {
    if (!fs::exists(kXvfbRun)) GTEST_SKIP() << "xvfb-run is not there";
  }
  static fs::path file(const std::string& name) { return *folder_ / name; }
  static fs::path store() { return file("city.strata"); }

  static Finished inX(std::vector<std::string> command) {
    command.insert(command.begin(), {"-a", "-s", "-screen 0 1024x768x24"});
    return runProgram(kXvfbRun, command);
  }
  /// The picture with the panels, as strata-view draws it of a store or a project.
  static Image pictureOf(const std::vector<std::string>& arguments, const std::string& name) {
    std::vector<std::string> command{programPath("strata-view").string(),
                                     "--backend",
                                     "cpu",
                                     "--size",
                                     "1000x700",
                                     "--screenshot",
                                     file(name).string()};
    command.insert(command.end(), arguments.begin(), arguments.end());
    const Finished finished = inX(command);
    EXPECT_EQ(finished.exitCode, 0) << finished.err;
    return finished.exitCode == 0 ? readPng(file(name).string()) : Image{};
  }
  /// A session of these steps; the projects it saved lie in the folder.
  static void handsOn(const std::string& argument, const std::string& saved, const std::string& steps) {
    std::ofstream(file("steps.txt")) << steps;
    const Finished session =
        inX({STRATA_SOURCE_DIR "/tests/system/viewer_steps.sh", programPath("strata-view").string(), file(".").string(),
             file("steps.txt").string(), saved, argument, "--backend", "cpu", "--size", "1000x700"});
    ASSERT_EQ(session.exitCode, 0) << session.err;
  }
  static Project project(const std::string& name) {
    const std::string path = file(name + ".project.json").string();
    Project read = parseProject(path, readWhole(path));
    read.view.width = kWidth;
    read.view.height = kHeight;
    return read;
  }
  /// Pixels between the panels that show points.
  static int pointPixels(const Image& image) {
    if (image.pixels.empty()) return -1;
    int points = 0;
    for (int y = kUpper; y < kLower; ++y)
      for (int x = kLeft; x < kRight; ++x)
        points += image.pixels[static_cast<std::size_t>(y * image.width + x)] != image.pixels[0] ? 1 : 0;
    return points;
  }

 private:
  static TempFolder* folder_;
};
TempFolder* ViewerTools::folder_ = nullptr;

TEST_F(ViewerTools, AClipBoxIsMadeByAKeyDraggedByItsHandleKeptAndCutsThePicture) {
  if (!fs::exists("/usr/bin/xdotool")) GTEST_SKIP() << "xdotool is not there";
  handsOn(store().string(), "city.project.json", "save plain\nkey b\nsave boxed\n");
  EXPECT_TRUE(project("plain").clipBoxes.empty());
  const Project boxed = project("boxed");
  ASSERT_EQ(boxed.clipBoxes.size(), 1u);

  const glm::dvec2 handle = pixelOf(boxed.view, handlePlace(boxed.clipBoxes[0].box, ClipHandle::top));
  ASSERT_TRUE(handle.x > kLeft && handle.x < kRight && handle.y > kUpper && handle.y < kLower);
  const auto at = [](const glm::dvec2& p) {
    return std::to_string(std::lround(p.x)) + " " + std::to_string(std::lround(p.y));
  };
  handsOn(file("boxed.project.json").string(), "boxed.project.json",
          "drag " + at(handle) + " " + at(handle - glm::dvec2(0.0, 60.0)) + "\nsave dragged\n");
  const Project dragged = project("dragged");
  ASSERT_EQ(dragged.clipBoxes.size(), 1u);
  const Box &before = boxed.clipBoxes[0].box, &after = dragged.clipBoxes[0].box;
  EXPECT_GT(after.max.z, before.max.z + 0.01 * before.size().z);
  EXPECT_EQ(after.min, before.min);
  EXPECT_EQ(glm::dvec2(after.max), glm::dvec2(before.max));
  EXPECT_EQ(dragged.view.eye, boxed.view.eye);  // the drag was the box's, not the camera's

  const int whole = pointPixels(pictureOf({file("plain.project.json").string()}, "plain.png"));
  const int inside = pointPixels(pictureOf({file("dragged.project.json").string()}, "boxed.png"));
  EXPECT_GT(inside, 500);
  EXPECT_LT(inside, whole / 2);
}

TEST_F(ViewerTools, AShortcutFliesNotThoughControlGoesUpBeforeItsLetter) {
  if (!fs::exists("/usr/bin/xdotool")) GTEST_SKIP() << "xdotool is not there";
  handsOn(store().string(), "city.project.json", "save first\ndown ctrl\ndown s\nup ctrl\nup s\nsave again\n");
  EXPECT_EQ(project("again").view.eye, project("first").view.eye);
}

TEST_F(ViewerTools, AClassThatIsHiddenInTheProjectIsNotDrawn) {
  handsOn(store().string(), "city.project.json", "save classes\n");
  const int whole = pointPixels(pictureOf({file("classes.project.json").string()}, "classes.png"));
  Json json = Json::parse(readWhole(file("classes.project.json")));
  EXPECT_TRUE(json["settings"]["hidden_classes"].empty());
  for (int c = 0; c < 256; ++c) json["settings"]["hidden_classes"].push_back(c);
  std::ofstream(file("none.project.json")) << json;
  const int nothing = pointPixels(pictureOf({file("none.project.json").string()}, "none.png"));
  EXPECT_GT(whole, 20'000);
  EXPECT_LT(nothing, whole / 20);
}

TEST_F(ViewerTools, AProfileIsDrawnByTwoClicksAndKeptWithItsWidth) {
  if (!fs::exists("/usr/bin/xdotool")) GTEST_SKIP() << "xdotool is not there";
  handsOn(store().string(), "city.project.json", "key x\nclick 420 330\nclick 560 330\nkey Return\nsave profile\n");
  const std::vector<Measurement> kept = project("profile").measurements;
  ASSERT_EQ(kept.size(), 1u);
  EXPECT_EQ(kept[0].kind, MeasureKind::profile);
  EXPECT_EQ(kept[0].points.size(), 2u);
  EXPECT_EQ(kept[0].width, profileWidth(kept[0].points));
}

TEST_F(ViewerTools, OfADamagedStoreTheRestIsShownAndTheDamageIsSaid) {
  const fs::path broken = file("broken.strata");
  fs::copy(store(), broken, fs::copy_options::recursive);
  std::string points = readWhole(broken / "points.bin");
  for (std::size_t i = points.size() / 2; i < points.size(); i += 64) points[i] = static_cast<char>(~points[i]);
  std::ofstream(broken / "points.bin", std::ios::binary) << points;
  const Image whole = pictureOf({store().string()}, "whole.png");
  const Image rest = pictureOf({broken.string()}, "rest.png");
  EXPECT_GT(pointPixels(rest), 2'000);
  // The message stands at the lower edge.
  int different = 0;
  for (int y = kHeight - 90; y < kHeight - 24; ++y)
    for (int x = 450; x < 550; ++x) {
      const auto at = static_cast<std::size_t>(y * kWidth + x);
      different += whole.pixels[at] != rest.pixels[at] ? 1 : 0;
    }
  EXPECT_GT(different, 2'000);
}

TEST_F(ViewerTools, AStoreThatIsLostStaysInTheProjectAndTheOthersAreShown) {
  if (!fs::exists("/usr/bin/xdotool")) GTEST_SKIP() << "xdotool is not there";
  Project two;
  two.stores = {file("gone.strata").string(), store().string()};
  two.shown = {false, true};
  const std::string path = file("two.project.json").string();
  std::ofstream(path) << projectJson(path, two);
  handsOn(path, "two.project.json", "key f\nsave again\n");
  const Project again = project("again");
  ASSERT_EQ(again.stores.size(), 2u);
  EXPECT_EQ(again.stores[0], two.stores[0]);
  EXPECT_EQ(again.shown, two.shown);
  const Finished nothing = inX({programPath("strata-view").string(), file("gone.strata").string(),
                                file("lost.strata").string(), "--screenshot", file("x.png").string()});
  EXPECT_EQ(nothing.exitCode, 1);
  EXPECT_NE(nothing.err.find("lost.strata"), std::string::npos) << nothing.err;
}

}  // namespace
}  // namespace strata::test
