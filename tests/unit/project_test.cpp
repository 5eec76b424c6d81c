#include "viewer/session/project.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/error.h"

namespace strata {
namespace {

Project someProject() {
  Project project;
  project.stores = {"/data/site/scan.strata", "/data/site/sub/other.strata"};
  project.shown = {true, false};
  project.view.eye = {630000.123456789, 4850000.987654321, 12.5};
  project.view.target = {630001.0, 4850000.0, 12.0};
  project.view.orthographic = true;
  project.view.orthographicHeight = 42.0;
  project.draw.colour = ColourMode::elevation;
  project.draw.elevationRange = {-3.5, 99.25};
  project.draw.pointSize = 4;
  project.draw.shading = Shading::highQuality;
  project.draw.background = {200, 210, 220};
  project.draw.backgroundBelow = glm::u8vec3(10, 20, 30);
  project.draw.fill = 5;
  project.draw.jumpFlood = true;
  project.draw.classes.reset(7).reset(255);
  project.clipBoxes = {{"the hall", {{1.5, 2.25, 3.0}, {630000.123456789, 5.0, 6.0}}, false, true},
                       {"the noise", {{1.0, 2.0, 3.0}, {4.0, 5.0, 6.0}}, true, false}};
  project.pointBudget = 12'345'678;
  project.pointsPerPixel = 1.75;
  project.bookmarks = {{"the \"tower\"", project.view}};
  project.measurements = {{"d", MeasureKind::distance, {{1, 2, 3}, {4, 5, 6.001}}, false, 1.0},
                          {"cut", MeasureKind::profile, {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}, true, 2.5}};
  project.path = CameraPath{24.0, PathSpeed::keyed, 1.0, {{0.0, {1, 2, 3}, {4, 5, 6}}, {2.5, {7, 8, 9}, {4, 5, 6}}}};
  return project;
}

TEST(Project, ComesBackAsItWasSaved) {
  const Project saved = someProject();
  const Project read = parseProject("/data/site/p.json", projectJson("/data/site/p.json", saved));
  EXPECT_EQ(read.stores, saved.stores);
  EXPECT_EQ(read.shown, saved.shown);
  EXPECT_EQ(read.view.eye, saved.view.eye);
  EXPECT_EQ(read.view.target, saved.view.target);
  EXPECT_TRUE(read.view.orthographic);
  EXPECT_EQ(read.view.orthographicHeight, 42.0);
  EXPECT_NEAR(read.view.fovY, saved.view.fovY, 1e-12);
  EXPECT_EQ(read.draw.colour, ColourMode::elevation);
  EXPECT_EQ(read.draw.elevationRange, saved.draw.elevationRange);
  EXPECT_EQ(read.draw.pointSize, 4);
  EXPECT_EQ(read.draw.shading, Shading::highQuality);
  EXPECT_EQ(read.draw.background, saved.draw.background);
  EXPECT_EQ(read.draw.backgroundBelow, saved.draw.backgroundBelow);
  EXPECT_EQ(read.draw.fill, 5);
  EXPECT_TRUE(read.draw.jumpFlood);
  EXPECT_EQ(read.draw.classes, saved.draw.classes);
  EXPECT_EQ(read.clipBoxes, saved.clipBoxes);
  EXPECT_EQ(read.pointBudget, saved.pointBudget);
  EXPECT_EQ(read.pointsPerPixel, saved.pointsPerPixel);
  ASSERT_EQ(read.bookmarks.size(), 1u);
  EXPECT_EQ(read.bookmarks[0].name, saved.bookmarks[0].name);
  EXPECT_EQ(read.measurements, saved.measurements);
  ASSERT_TRUE(read.path);
  EXPECT_EQ(cameraPathJson(*read.path), cameraPathJson(*saved.path));
}

TEST(Project, MovesWithItsFolder) {
  const std::string text = projectJson("/data/site/p.json", someProject());
  const Project read = parseProject("/elsewhere/p.json", text);
  EXPECT_EQ(read.stores[0], "/elsewhere/scan.strata");
  EXPECT_EQ(read.stores[1], "/elsewhere/sub/other.strata");
}

TEST(Project, NamesWhatIsWrong) {
  const auto refusal = [](const std::string& text) -> std::string {
    try {
      parseProject("p.json", text);
    } catch (const Error& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_NE(refusal("nonsense").find("p.json: is no JSON"), std::string::npos);
  EXPECT_NE(refusal("{}").find("no project"), std::string::npos);
  EXPECT_NE(refusal(R"({"strata_project":9})").find("version"), std::string::npos);
  EXPECT_NE(refusal(R"({"strata_project":1})").find("stores"), std::string::npos);
  EXPECT_NE(refusal(R"({"strata_project":1,"stores":[{"path":"a"}],"camera":{"eye":[1,2]}})").find("camera.eye"),
            std::string::npos);
  EXPECT_NE(refusal(R"({"strata_project":1,"stores":[{"path":"a"}],"settings":{"point_size":900}})").find("point_size"),
            std::string::npos);
  EXPECT_NE(refusal(R"({"strata_project":1,"stores":[{"path":"a"}],"measurements":[{"kind":"volume"}]})").find("kind"),
            std::string::npos);
  EXPECT_NE(refusal(R"({"strata_project":1,"stores":[{"path":"a"}],"clip_boxes":[{"from":[1,2,3],"to":[0,3,4]}]})")
                .find("clip_boxes.to"),
            std::string::npos);
  EXPECT_NE(refusal(R"({"strata_project":1,"stores":[{"path":"a"}],"settings":{"hidden_classes":[-1]}})")
                .find("hidden_classes"),
            std::string::npos);
  EXPECT_EQ(refusal(R"({"strata_project":1,"stores":[{"path":"a"}]})"), "accepted");
}

TEST(Project, EveryTruncationIsRefusedOrReadWithoutACrash) {
  const std::string text = projectJson("/p.json", someProject());
  for (std::size_t length = 0; length < text.size(); ++length) {
    try {
      parseProject("/p.json", text.substr(0, length));
    } catch (const Error&) {
    }
  }
}

}  // namespace
}  // namespace strata
