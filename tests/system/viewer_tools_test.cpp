// The tools of strata-view, used by mouse and keys in a virtual X server: clip boxes, classes, profiles, camera paths;
// and stores that are damaged or lost.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/image.h"
#include "tests/support/viewer_hand.h"
#include "viewer/camera/camera_control.h"
#include "viewer/session/project.h"

namespace strata::test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kXvfbRun = "/usr/bin/xvfb-run";
constexpr int kWidth = 1000, kHeight = 700;
// The part of the picture between the panels.
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
    command.insert(command.begin(), {"-a", "-s", "-screen 0 1024x768x24 -noreset"});
    return runProgram(kXvfbRun, command);
  }
  /// The window, picture and panels, as strata-view shows a store or a project.
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
  /// A viewer that shows `argument`, started in the folder.
  static ViewerHand handOn(const std::string& argument) {
    return {file("."), {argument, "--backend", "cpu", "--size", "1000x700"}};
  }
  /// Saves with Control + S, which writes `saved`, so that project(`name`) reads it.
  static void save(ViewerHand& hand, const std::string& saved, const std::string& name) {
    hand.save(saved);
    if (saved != name + ".project.json")
      fs::copy_file(file(saved), file(name + ".project.json"), fs::copy_options::overwrite_existing);
  }
  static Project project(const std::string& name) {
    const std::string path = file(name + ".project.json").string();
    Project read = parseProject(path, readWhole(path));
    read.view.width = kWidth;
    read.view.height = kHeight;
    return read;
  }
  /// The number of pixels between the panels that show points.
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
  if (!ViewerHand::possible()) GTEST_SKIP() << "Xvfb or xdotool is not there";
  {
    ViewerHand hand = handOn(store().string());
    save(hand, "city.project.json", "plain");
    hand.key("b");
    save(hand, "city.project.json", "boxed");
    EXPECT_EQ(hand.quit(), 0) << hand.said();
  }
  EXPECT_TRUE(project("plain").clipBoxes.empty());
  const Project boxed = project("boxed");
  ASSERT_EQ(boxed.clipBoxes.size(), 1u);

  const glm::dvec2 handle = pixelOf(boxed.view, handlePlace(boxed.clipBoxes[0].box, ClipHandle::top));
  ASSERT_TRUE(handle.x > kLeft && handle.x < kRight && handle.y > kUpper && handle.y < kLower);
  {
    ViewerHand hand = handOn(file("boxed.project.json").string());
    const auto x = static_cast<int>(std::lround(handle.x)), y = static_cast<int>(std::lround(handle.y));
    hand.drag(x, y, x, y - 60);
    save(hand, "boxed.project.json", "dragged");
    EXPECT_EQ(hand.quit(), 0) << hand.said();
  }
  const Project dragged = project("dragged");
  ASSERT_EQ(dragged.clipBoxes.size(), 1u);
  const Box &before = boxed.clipBoxes[0].box, &after = dragged.clipBoxes[0].box;
  EXPECT_GT(after.max.z, before.max.z + 0.01 * before.size().z);
  EXPECT_EQ(after.min, before.min);
  EXPECT_EQ(glm::dvec2(after.max), glm::dvec2(before.max));
  EXPECT_EQ(dragged.view.eye, boxed.view.eye);  // the drag moved the handle, not the camera

  const int whole = pointPixels(pictureOf({file("plain.project.json").string()}, "plain.png"));
  const int inside = pointPixels(pictureOf({file("dragged.project.json").string()}, "boxed.png"));
  EXPECT_GT(inside, 500);
  EXPECT_LT(inside, whole / 2);
}

TEST_F(ViewerTools, AShortcutDoesNotFlyWhenControlGoesUpBeforeItsLetter) {
  if (!ViewerHand::possible()) GTEST_SKIP() << "Xvfb or xdotool is not there";
  ViewerHand hand = handOn(store().string());
  save(hand, "city.project.json", "first");
  hand.keyDown("ctrl");
  hand.keyDown("s");
  hand.keyUp("ctrl");
  hand.frames(3);
  hand.keyUp("s");
  save(hand, "city.project.json", "again");
  EXPECT_EQ(hand.quit(), 0) << hand.said();
  EXPECT_EQ(project("again").view.eye, project("first").view.eye);
}

TEST_F(ViewerTools, AClassIsHiddenByItsCheckBoxAndStaysSoInTheProject) {
  if (!ViewerHand::possible()) GTEST_SKIP() << "Xvfb or xdotool is not there";
  ViewerHand hand = handOn(store().string());
  save(hand, "city.project.json", "classes");
  EXPECT_TRUE(project("classes").draw.classes.all());
  hand.clickItem("Classes");
  hand.clickItem("class 2");
  hand.until("hidden_classes", 1);
  save(hand, "city.project.json", "no_ground");
  hand.clickItem("only class 6");
  hand.until("hidden_classes", 255);
  save(hand, "city.project.json", "buildings");
  hand.clickItem("class 6");
  hand.until("hidden_classes", 256);
  save(hand, "city.project.json", "nothing");
  EXPECT_EQ(hand.quit(), 0) << hand.said();

  EXPECT_EQ(project("no_ground").draw.classes, std::bitset<256>().set().reset(2));
  EXPECT_EQ(project("buildings").draw.classes, std::bitset<256>().set(6));
  const auto drawn = [](const std::string& name) {
    return pointPixels(pictureOf({file(name + ".project.json").string()}, name + ".png"));
  };
  const int whole = drawn("classes");
  EXPECT_GT(whole, 20'000);
  EXPECT_LT(drawn("no_ground"), whole);
  EXPECT_GT(drawn("buildings"), 1'000);
  EXPECT_LT(drawn("nothing"), whole / 20);
}

TEST_F(ViewerTools, AProfileIsDrawnByTwoClicksShownInItsWindowAndKeptWithItsWidth) {
  if (!ViewerHand::possible()) GTEST_SKIP() << "Xvfb or xdotool is not there";
  ViewerHand hand = handOn(store().string());
  hand.key("x");
  hand.click(420, 330);
  hand.until("measuring", 1);
  hand.click(560, 330);
  hand.until("measuring", 2);
  hand.key("Return");
  hand.until("measured", 1);
  // The profile's window opens at once and shows the points in the slab.
  const Json place = hand.settled().at("items").at("profile");
  if (fs::exists("/usr/bin/ffmpeg")) {
    hand.photograph("profile.png");
    const Image image = readPng(file("profile.png").string());
    const auto x = place[0].get<int>(), y = place[1].get<int>();
    std::map<std::uint32_t, int> colours;
    for (int dy = -60; dy < 60; ++dy)
      for (int dx = -150; dx < 150; ++dx)
        ++colours[image.pixels[static_cast<std::size_t>((y + dy) * image.width + x + dx)]];
    int ground = 0;  // pixels of the commonest colour, which is the background
    for (const auto& [colour, count] : colours) ground = std::max(ground, count);
    EXPECT_LT(ground, 300 * 120 - 200);
    EXPECT_GT(ground, 300 * 120 / 4);
  }
  save(hand, "city.project.json", "profile");
  EXPECT_EQ(hand.quit(), 0) << hand.said();
  const std::vector<Measurement> kept = project("profile").measurements;
  ASSERT_EQ(kept.size(), 1u);
  EXPECT_EQ(kept[0].kind, MeasureKind::profile);
  EXPECT_EQ(kept[0].points.size(), 2u);
  EXPECT_EQ(kept[0].width, profileWidth(kept[0].points));
}

TEST_F(ViewerTools, ACameraPathComesBackWithItsProject) {
  if (!ViewerHand::possible()) GTEST_SKIP() << "Xvfb or xdotool is not there";
  {
    ViewerHand hand = handOn(store().string());
    hand.key("k");
    hand.drag(420, 350, 480, 350);
    hand.key("k");
    save(hand, "city.project.json", "path");
    EXPECT_EQ(hand.quit(), 0) << hand.said();
  }
  ViewerHand again = handOn(file("path.project.json").string());
  EXPECT_EQ(again.settled().at("path_keys"), 2);
  const Json eye = again.state().at("eye");
  again.key("space");
  again.until("the flight to end", [&](const Json& s) { return s.at("settled").get<bool>(); });
  for (int i = 0; i < 3; ++i)  // the flight ends at its last key, where the project was saved
    EXPECT_NEAR(again.state().at("eye")[i].get<double>(), eye[i].get<double>(), 1e-6);
  EXPECT_EQ(again.quit(), 0) << again.said();
}

TEST_F(ViewerTools, WhatProgressiveDrawingCannotDoCannotBeChosen) {
  if (!ViewerHand::possible()) GTEST_SKIP() << "Xvfb or xdotool is not there";
  for (const bool progressive : {true, false}) {
    ViewerHand hand(file("."), {store().string(), "--size", "1000x700", progressive ? "--progressive" : "--backend",
                                progressive ? "0.1" : "cpu"});
    hand.clickItem("high-quality shading");
    EXPECT_EQ(hand.save("city.project.json").at("settings").at("high_quality").get<bool>(), !progressive);
    EXPECT_EQ(hand.quit(), 0) << hand.said();
  }
}

TEST_F(ViewerTools, ClicksThatComeFasterThanTheFramesAllCount) {
  if (!ViewerHand::possible()) GTEST_SKIP() << "Xvfb or xdotool is not there";
  ViewerHand hand = handOn(store().string());
  hand.key("m");
  hand.clicksAtOnce({{420, 330}, {560, 330}, {450, 400}, {540, 400}});
  hand.until("measured", 2);
  hand.key("Escape");
  const Json before = hand.settled().at("eye");
  hand.doubleClick(480, 350);
  hand.until("the glide", [&](const Json& s) { return s.at("eye") != before && s.at("settled").get<bool>(); });
  EXPECT_EQ(hand.quit(), 0) << hand.said();
}

TEST_F(ViewerTools, ADamagedStoreIsShownWithoutTheDamageWhichIsReported) {
  const fs::path broken = file("broken.strata");
  fs::copy(store(), broken, fs::copy_options::recursive);
  std::string points = readWhole(broken / "points.bin");
  for (std::size_t i = points.size() / 2; i < points.size(); i += 64) points[i] = static_cast<char>(~points[i]);
  std::ofstream(broken / "points.bin", std::ios::binary) << points;
  const Image whole = pictureOf({store().string()}, "whole.png");
  const Image rest = pictureOf({broken.string()}, "rest.png");
  EXPECT_GT(pointPixels(rest), 2'000);
  // The message is shown at the lower edge.
  int different = 0;
  for (int y = kHeight - 90; y < kHeight - 24; ++y)
    for (int x = 450; x < 550; ++x) {
      const auto at = static_cast<std::size_t>(y * kWidth + x);
      different += whole.pixels[at] != rest.pixels[at] ? 1 : 0;
    }
  EXPECT_GT(different, 2'000);
}

TEST_F(ViewerTools, AStoreThatIsLostStaysInTheProjectAndTheOthersAreShown) {
  if (!ViewerHand::possible()) GTEST_SKIP() << "Xvfb or xdotool is not there";
  Project two;
  two.stores = {file("gone.strata").string(), store().string()};
  two.shown = {false, true};
  const std::string path = file("two.project.json").string();
  std::ofstream(path) << projectJson(path, two);
  ViewerHand hand = handOn(path);
  save(hand, "two.project.json", "again");
  EXPECT_EQ(hand.quit(), 0) << hand.said();
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
