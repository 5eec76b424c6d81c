#include "viewer/tools/clip_boxes.h"

#include <gtest/gtest.h>

#include <random>

#include "viewer/camera/camera_control.h"

namespace strata {
namespace {

const glm::dvec3 kPlace(630000.0, 4850000.0, 300.0);
const Box kBox{kPlace - glm::dvec3(5.0, 8.0, 3.0), kPlace + glm::dvec3(5.0, 8.0, 3.0)};

View someView(bool orthographic) {
  View view;
  view.eye = kPlace + glm::dvec3(30.0, -40.0, 25.0);
  view.target = kPlace;
  view.width = 800;
  view.height = 600;
  view.orthographic = orthographic;
  view.orthographicHeight = 60.0;
  return view;
}

TEST(ClipBoxes, AFaceFollowsTheCursorAlongItsAxisAndNothingElseMoves) {
  for (const bool orthographic : {false, true})
    for (int face = 0; face < 6; ++face) {
      const View view = someView(orthographic);
      const auto handle = static_cast<ClipHandle>(face);
      const glm::dvec3 from = handlePlace(kBox, handle);
      glm::dvec3 to = from;
      to[face / 2] += face % 2 == 0 ? -1.75 : 2.25;
      const Box next = draggedBox(kBox, handle, view, pixelOf(view, from), pixelOf(view, to));
      EXPECT_LT(glm::distance(handlePlace(next, handle)[face / 2] * glm::dvec3(1.0), to[face / 2] * glm::dvec3(1.0)),
                1e-6);
      for (int other = 0; other < 6; ++other) {
        if (other == face) continue;
        const auto axis = other / 2;
        EXPECT_EQ(handlePlace(next, static_cast<ClipHandle>(other))[axis],
                  handlePlace(kBox, static_cast<ClipHandle>(other))[axis]);
      }
    }
}

TEST(ClipBoxes, AFaceNeverPassesTheOppositeOne) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> pixel(-5000.0, 5000.0);
  for (int i = 0; i < 2000; ++i) {
    const View view = someView(i % 2 == 0);
    const auto handle = static_cast<ClipHandle>(i % 6);
    const glm::dvec2 from = pixelOf(view, handlePlace(kBox, handle));
    const Box next = draggedBox(kBox, handle, view, from, {pixel(random), pixel(random)});
    EXPECT_FALSE(next.empty());
    EXPECT_TRUE(glm::all(glm::greaterThan(next.size(), glm::dvec3(0.0))));
  }
}

TEST(ClipBoxes, AnAxisSeenEndOnDoesNotMove) {
  View view = someView(true);
  view.eye = kPlace + glm::dvec3(0.0, 0.0, 50.0);
  view.up = {0.0, 1.0, 0.0};
  const Box next = draggedBox(kBox, ClipHandle::top, view, {400.0, 300.0}, {420.0, 250.0});
  EXPECT_EQ(next.max, kBox.max);
  EXPECT_EQ(next.min, kBox.min);
}

TEST(ClipBoxes, TheCentreTakesTheBoxAlongUnderTheCursor) {
  for (const bool orthographic : {false, true}) {
    const View view = someView(orthographic);
    const glm::dvec2 from = pixelOf(view, kBox.centre());
    const glm::dvec2 to = from + glm::dvec2(60.0, -35.0);
    const Box next = draggedBox(kBox, ClipHandle::centre, view, from, to);
    EXPECT_LT(glm::distance(next.size(), kBox.size()), 1e-8);
    EXPECT_LT(glm::distance(pixelOf(view, next.centre()), to), 1e-5);
  }
}

TEST(ClipBoxes, ADragAndItsWayBackLeaveTheBoxAsItWas) {
  ClipTool tool;
  tool.add(kBox);
  const View view = someView(false);
  const glm::dvec2 at = pixelOf(view, handlePlace(kBox, ClipHandle::right));
  ASSERT_TRUE(tool.press(view, at));
  EXPECT_TRUE(tool.move(view, at + glm::dvec2(50.0, 20.0)));
  EXPECT_TRUE(tool.move(view, at));
  EXPECT_LT(glm::distance(tool.boxes()[0].box.max, kBox.max), 1e-6);
  EXPECT_FALSE(tool.move(view, at));
  tool.release();
  EXPECT_FALSE(tool.move(view, at + glm::dvec2(9.0)));
}

TEST(ClipBoxes, OnlyHandlesOfBoxesThatAreOnAndBeforeTheEyeAreTaken) {
  ClipTool tool;
  tool.add(kBox);
  View view = someView(false);
  const glm::dvec2 top = pixelOf(view, handlePlace(kBox, ClipHandle::top));
  EXPECT_EQ(tool.gripAt(view, top + glm::dvec2(3.0, 3.0)), (ClipTool::Grip{0, ClipHandle::top}));
  EXPECT_FALSE(tool.gripAt(view, top + glm::dvec2(0.0, -40.0)));
  tool.boxes()[0].on = false;
  EXPECT_FALSE(tool.press(view, top));
  tool.boxes()[0].on = true;
  view.target = view.eye + (view.eye - view.target);
  EXPECT_FALSE(tool.gripAt(view, {400.0, 300.0}));
}

TEST(ClipBoxes, BecomeBoxesAndCutoutsForDrawing) {
  std::vector<ClipBox> boxes{{"a", kBox, false, true}, {"b", kBox, true, true}, {"c", kBox, false, false}};
  const Clip clip = clipOf(boxes, {glm::dvec4(1.0)});
  EXPECT_EQ(clip.boxes.size(), 1u);
  EXPECT_EQ(clip.cutouts.size(), 1u);
  EXPECT_EQ(clip.planes.size(), 1u);
  boxes.assign(9, boxes.front());
  EXPECT_EQ(clipOf(boxes, {}).boxes.size(), Clip::kMost);
}

TEST(ClipBoxes, AreNamedApartAndLimited) {
  ClipTool tool;
  for (std::size_t i = 0; i < Clip::kMost; ++i) EXPECT_TRUE(tool.add(kBox));
  EXPECT_FALSE(tool.add(kBox));
  tool.remove(0);
  ASSERT_TRUE(tool.add(kBox));
  EXPECT_EQ(tool.boxes().back().name, "box 1");
}

TEST(ClipBoxes, ANewBoxIsInTheMiddleOfThePictureAndOfTheScan) {
  const View view = someView(false);
  const Box bounds{kPlace - 200.0, kPlace + glm::dvec3(200.0, 200.0, 1.0)};
  const Box box = boxInView(view, bounds);
  EXPECT_TRUE(box.contains(kPlace));
  EXPECT_LE(box.max.z, bounds.max.z);
  for (int h = 0; h < kClipHandles; ++h) {
    const glm::dvec2 pixel = pixelOf(view, handlePlace(box, static_cast<ClipHandle>(h)));
    EXPECT_TRUE(pixel.x > 0.0 && pixel.x < 800.0 && pixel.y > 0.0 && pixel.y < 600.0);
  }
  // A target far outside, and a scan as flat as a sheet, give a box all the same.
  View away = view;
  away.target += glm::dvec3(5000.0, 0.0, 0.0);
  EXPECT_FALSE(boxInView(away, {kPlace, kPlace + glm::dvec3(10.0, 10.0, 0.0)}).empty());
}

TEST(ClipBoxes, HaveTwelveEdgesOfTheirOwnSides) {
  double length = 0.0;
  for (const auto& [a, b] : edgesOf(kBox)) length += glm::distance(a, b);
  EXPECT_EQ(edgesOf(kBox).size(), 12u);
  EXPECT_NEAR(length, 4.0 * (10.0 + 16.0 + 6.0), 1e-6);
}

}  // namespace
}  // namespace strata
