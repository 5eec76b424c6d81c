#include "viewer/camera/camera_control.h"

#include <gtest/gtest.h>

#include <random>

namespace strata {
namespace {

/// A view at UTM coordinates with the eye between 2 and 200 m from the target and no extreme slope.
View randomView(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  View view;
  view.target = {630000.0 + 500.0 * unit(random), 4850000.0 + 500.0 * unit(random), 100.0 * unit(random)};
  const glm::dvec3 direction = glm::normalize(glm::dvec3(unit(random), unit(random) + 1.1, 0.8 * unit(random)));
  view.eye = view.target - direction * (101.0 + 99.0 * unit(random));
  view.width = 1280;
  view.height = 720;
  view.orthographic = unit(random) > 0.5;
  view.orthographicHeight = 50.0;
  return view;
}

glm::dvec2 randomPixel(std::mt19937& random, const View& view) {
  return {std::uniform_real_distribution<double>(0.0, view.width)(random),
          std::uniform_real_distribution<double>(0.0, view.height)(random)};
}

TEST(CameraControl, FindsTheWorldPointOfAPixelAndBack) {
  std::mt19937 random(1);
  for (int i = 0; i < 200; ++i) {
    const View view = randomView(random);
    const glm::dvec2 pixel = randomPixel(random, view);
    const glm::dvec3 point = worldPoint(view, pixel, 37.0);
    EXPECT_NEAR(depthOf(view, point), 37.0, 1e-6);
    EXPECT_LT(glm::distance(pixelOf(view, point), pixel), 1e-4);
  }
}

TEST(CameraControl, OrbitKeepsTheDistanceToThePivotAndToTheTarget) {
  std::mt19937 random(2);
  for (int i = 0; i < 200; ++i) {
    const View view = randomView(random);
    const glm::dvec3 pivot = worldPoint(view, randomPixel(random, view), 20.0);
    const View next = orbited(view, pivot, randomPixel(random, view) - glm::dvec2(600.0, 300.0));
    EXPECT_NEAR(glm::distance(next.eye, pivot), glm::distance(view.eye, pivot), 1e-6);
    EXPECT_NEAR(glm::distance(next.eye, next.target), glm::distance(view.eye, view.target), 1e-6);
  }
}

TEST(CameraControl, OrbitKeepsThePivotAtItsDepthAndTheHorizonLevel) {
  std::mt19937 random(3);
  for (int i = 0; i < 200; ++i) {
    const View view = randomView(random);
    const glm::dvec3 pivot = worldPoint(view, randomPixel(random, view), 20.0);
    const View next = orbited(view, pivot, {77.0, -31.0});
    EXPECT_NEAR(depthOf(next, pivot), 20.0, 1e-6);
    EXPECT_NEAR(viewBasis(next).right.z, 0.0, 1e-9);
  }
}

TEST(CameraControl, OrbitThereAndBackIsTheSameView) {
  std::mt19937 random(4);
  for (int i = 0; i < 100; ++i) {
    const View view = randomView(random);
    const View back = orbited(orbited(view, view.target, {90.0, 12.0}), view.target, {-90.0, -12.0});
    EXPECT_LT(glm::distance(back.eye, view.eye), 1e-6);
  }
}

TEST(CameraControl, OrbitNeverTipsOver) {
  View view;
  view.eye = {0.0, -10.0, 2.0};
  for (int i = 0; i < 100; ++i) view = orbited(view, glm::dvec3(0.0), {0.0, 50.0});
  EXPECT_GT(view.eye.z, 9.9);
  EXPECT_LE(view.eye.y, 0.0);
  for (int i = 0; i < 100; ++i) view = orbited(view, glm::dvec3(0.0), {0.0, -50.0});
  EXPECT_LT(view.eye.z, -9.9);
}

TEST(CameraControl, DraggingRightTurnsTheSceneRight) {
  View view;
  view.eye = {0.0, -10.0, 0.0};
  const glm::dvec3 nearPoint(0.0, -1.0, 0.0);
  EXPECT_GT(pixelOf(orbited(view, glm::dvec3(0.0), {100.0, 0.0}), nearPoint).x, pixelOf(view, nearPoint).x);
  EXPECT_GT(pixelOf(orbited(view, glm::dvec3(0.0), {0.0, 100.0}), nearPoint).y, pixelOf(view, nearPoint).y);
}

TEST(CameraControl, PanMovesTheGrabbedPointWithTheCursor) {
  std::mt19937 random(5);
  for (int i = 0; i < 200; ++i) {
    const View view = randomView(random);
    const glm::dvec2 from = randomPixel(random, view);
    const glm::dvec2 to = randomPixel(random, view);
    const glm::dvec3 grabbed = worldPoint(view, from, 45.0);
    const View next = panned(view, 45.0, to - from);
    EXPECT_LT(glm::distance(pixelOf(next, grabbed), to), 1e-4);
    EXPECT_LT(glm::distance(next.target - next.eye, view.target - view.eye), 1e-8);
  }
}

TEST(CameraControl, ZoomKeepsTheAnchorUnderTheCursor) {
  std::mt19937 random(6);
  for (int i = 0; i < 200; ++i) {
    const View view = randomView(random);
    const glm::dvec2 pixel = randomPixel(random, view);
    const glm::dvec3 anchor = worldPoint(view, pixel, 30.0);
    const View next = zoomed(view, anchor, 0.7);
    EXPECT_LT(glm::distance(pixelOf(next, anchor), pixel), 1e-3);
    EXPECT_NEAR(glm::distance(next.eye, anchor), 0.7 * glm::distance(view.eye, anchor), 1e-6);
  }
}

TEST(CameraControl, ZoomStopsBeforeTheAnchorIsReached) {
  View view;
  for (int i = 0; i < 1000; ++i) view = zoomed(view, glm::dvec3(0.0), 0.5);
  EXPECT_GT(glm::distance(view.eye, view.target), 0.0);
  EXPECT_LT(glm::distance(zoomed(view, glm::dvec3(0.0), 1e6).eye, glm::dvec3(0.0, -200.0, 0.0)), 200.0);
}

TEST(CameraControl, AWheelNotchThereAndBackIsTheSameView) {
  CameraControl control{View{}};
  const View before = control.view();
  control.wheel(3.0, {100.0, 200.0}, glm::dvec3(0.3, 0.2, 0.1));
  EXPECT_LT(glm::distance(control.view().eye, glm::dvec3(0.3, 0.2, 0.1)),
            glm::distance(before.eye, glm::dvec3(0.3, 0.2, 0.1)));
  control.wheel(-3.0, {100.0, 200.0}, glm::dvec3(0.3, 0.2, 0.1));
  EXPECT_LT(glm::distance(control.view().eye, before.eye), 1e-12);
}

TEST(CameraControl, FlyingForwardIsTowardTheTargetAndFasterWithShift) {
  View view;
  view.eye = {0.0, -10.0, 0.0};
  const View slow = flown(view, {.forward = 1}, 0.1);
  const View fast = flown(view, {.forward = 1, .fast = true}, 0.1);
  EXPECT_NEAR(slow.eye.y, -9.5, 1e-9);
  EXPECT_NEAR(fast.eye.y, -7.5, 1e-9);
  EXPECT_NEAR(glm::distance(slow.eye, slow.target), 10.0, 1e-9);
  EXPECT_GT(flown(view, {.right = 1}, 0.1).eye.x, 0.0);
  EXPECT_GT(flown(view, {.up = 1}, 0.1).eye.z, 0.0);
}

TEST(CameraControl, StandardViewsShowTheWholeBox) {
  Box box;
  box.add(glm::dvec3(630000.0, 4850000.0, 10.0));
  box.add(glm::dvec3(630400.0, 4850100.0, 60.0));
  View view;
  for (const StandardView which : {StandardView::front, StandardView::side, StandardView::top}) {
    const View seen = standardView(view, box, which);
    for (int corner = 0; corner < 8; ++corner) {
      const glm::dvec3 p((corner & 1 ? box.max : box.min).x, (corner & 2 ? box.max : box.min).y,
                         (corner & 4 ? box.max : box.min).z);
      const glm::dvec2 pixel = pixelOf(seen, p);
      EXPECT_TRUE(pixel.x >= 0.0 && pixel.x <= seen.width && pixel.y >= 0.0 && pixel.y <= seen.height);
    }
  }
  EXPECT_GT(standardView(view, box, StandardView::top).eye.z, 60.0);
  EXPECT_LT(standardView(view, box, StandardView::front).eye.y, 4850000.0);
  EXPECT_GT(standardView(view, box, StandardView::side).eye.x, 630400.0);
}

TEST(CameraControl, OrbitingOutOfTheTopViewDoesNotSpinThePicture) {
  Box box;
  box.add(glm::dvec3(-1.0));
  box.add(glm::dvec3(1.0));
  const View top = standardView(View{}, box, StandardView::top);
  const View next = orbited(top, top.target, {0.0, -1.0});
  EXPECT_GT(glm::dot(viewBasis(top).right, viewBasis(next).right), 0.999);
}

TEST(CameraControl, ADragWithoutAPressDoesNothing) {
  CameraControl control{View{}};
  const View before = control.view();
  control.move({50.0, 50.0});
  control.release();
  EXPECT_EQ(control.view(), before);
}

TEST(CameraControl, WithoutPerspectiveTheTargetKeepsItsSizeThereAndBack) {
  View view;
  view.eye = {10, -30, 12};
  view.target = {1, 2, 3};
  const glm::dvec3 up = viewBasis(view).up;
  const View flat = withOrthographic(view, true);
  EXPECT_NEAR(glm::distance(pixelOf(view, view.target + 1e-4 * up), pixelOf(view, view.target)) /
                  glm::distance(pixelOf(flat, view.target + 1e-4 * up), pixelOf(flat, view.target)),
              1.0, 1e-4);
  const View back = withOrthographic(flat, false);
  EXPECT_LT(glm::distance(back.eye, view.eye), 1e-9);
  EXPECT_FALSE(back.orthographic);
}

TEST(CameraControl, AGlideBeginsAndEndsWhereItShouldAndNeverComesNearerThanItsEnds) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> place(-50.0, 50.0);
  for (int round = 0; round < 200; ++round) {
    View a, b;
    a.eye = {place(random), place(random), place(random)};
    a.target = {place(random), place(random), place(random)};
    b.eye = {place(random), place(random), place(random)};
    b.target = round % 10 == 0 ? b.eye + (a.eye - a.target) : glm::dvec3(place(random), place(random), place(random));
    EXPECT_LT(glm::distance(glided(a, b, 0.0).eye, a.eye), 1e-9);
    EXPECT_EQ(glided(a, b, 1.0).eye, b.eye);
    const double least = std::min(glm::distance(a.eye, a.target), glm::distance(b.eye, b.target));
    for (double u = 0.0; u < 1.0; u += 0.05) {
      const View now = glided(a, b, u);
      EXPECT_GE(glm::distance(now.eye, now.target), least * (1.0 - 1e-9));
    }
  }
}

TEST(CameraControl, AGlideTakesItsTimeWhateverTheFrameRateAndAHandStopsIt) {
  View there;
  there.eye = {100, 100, 100};
  for (const int frames : {3, 60, 1000}) {
    CameraControl control{View{}};
    control.glideTo(there);
    for (int i = 0; i < frames; ++i) control.advance(CameraControl::kGlideSeconds / frames * 1.0001);
    EXPECT_FALSE(control.gliding());
    EXPECT_EQ(control.view().eye, there.eye);
  }
  CameraControl control{View{}};
  control.glideTo(there);
  control.advance(0.1);
  control.press(CameraControl::Drag::orbit, {1, 1}, std::nullopt);
  EXPECT_FALSE(control.gliding());
}

TEST(CameraControl, ADoubleClickBringsThePointToTheMiddle) {
  View view;
  view.eye = {10, -30, 12};
  view.target = {1, 2, 3};
  const glm::dvec3 point(4, 4, 1);
  const View near = approached(view, point);
  EXPECT_LT(glm::distance(pixelOf(near, point), glm::dvec2(0.5 * near.width, 0.5 * near.height)), 1e-6);
  EXPECT_NEAR(glm::distance(near.eye, point), 0.4 * glm::distance(view.eye, point), 1e-9);
}

TEST(CameraControl, AGrabbedPointOfTheGroundStaysUnderTheCursorAndTheEyeKeepsItsHeight) {
  std::mt19937 random(11);
  int moved = 0;
  for (int i = 0; i < 500; ++i) {
    View view = randomView(random);
    view.eye.z = view.target.z + 5.0 + 50.0 * std::uniform_real_distribution<double>(0.0, 1.0)(random);
    const glm::dvec2 from = randomPixel(random, view), to = randomPixel(random, view);
    const glm::dvec3 grabbed = worldPoint(view, from, std::uniform_real_distribution<double>(5.0, 100.0)(random));
    CameraControl control(view);
    control.setMode(MoveMode::earth);
    control.pressLeft(from, grabbed);
    control.move(to);
    const View& next = control.view();
    EXPECT_EQ(next.eye.z, view.eye.z);
    EXPECT_LT(glm::distance(next.target - next.eye, view.target - view.eye), 1e-6);
    if (next.eye == view.eye) continue;
    ++moved;
    EXPECT_LT(glm::distance(pixelOf(next, grabbed), to), 1e-4);
    // Back again by many small steps: the hand has come home, and the camera with it.
    for (int step = 1; step <= 10; ++step) control.move(glm::mix(to, from, step / 10.0));
    EXPECT_LT(glm::distance(control.view().eye, view.eye), 1e-5);
  }
  EXPECT_GT(moved, 200);
}

TEST(CameraControl, AGrabbedPointDraggedToTheHorizonIsLetBe) {
  View view;
  view.eye = {0.0, -10.0, 3.0};
  view.target = {0.0, 0.0, 2.0};
  const glm::dvec3 grabbed(0.0, -4.0, 0.0);
  for (double y = pixelOf(view, grabbed).y; y > -200.0; y -= 1.0) {
    const View next = slid(view, grabbed, {700.0, y});
    EXPECT_LE(glm::distance(next.eye, view.eye), kFarthestSlide * glm::distance(view.eye, grabbed));
  }
  EXPECT_EQ(slid(view, grabbed, {700.0, 0.0}).eye, view.eye);
}

TEST(CameraControl, TheButtonsMeanWhatTheModeSays) {
  View view;
  view.eye = {0.0, -10.0, 5.0};
  const glm::dvec3 under(1.0, 1.0, 0.0);
  const glm::dvec2 from = pixelOf(view, under), to = from + glm::dvec2(60.0, 25.0);
  const auto dragged = [&](MoveMode mode, bool left) {
    CameraControl control(view);
    control.setMode(mode);
    if (left)
      control.pressLeft(from, under);
    else
      control.pressRight(from, under);
    control.move(to);
    return control.view();
  };
  EXPECT_EQ(dragged(MoveMode::orbit, true).eye, orbited(view, under, to - from).eye);
  EXPECT_LT(glm::distance(pixelOf(dragged(MoveMode::orbit, false), under), to), 1e-6);
  EXPECT_LT(glm::distance(dragged(MoveMode::fly, true).eye, view.eye), 1e-12);
  EXPECT_GT(viewBasis(dragged(MoveMode::fly, true)).forward.x, viewBasis(view).forward.x);
  EXPECT_LT(glm::distance(pixelOf(dragged(MoveMode::fly, false), under), to), 1e-6);
  EXPECT_LT(glm::distance(pixelOf(dragged(MoveMode::earth, true), under), to), 1e-6);
  EXPECT_EQ(dragged(MoveMode::earth, false).eye, orbited(view, under, to - from).eye);
}

TEST(CameraControl, WhileFlyingTheWheelSetsThePaceAndLeavesTheEye) {
  CameraControl control(View{});
  control.setMode(MoveMode::fly);
  const double before = flySpeed(control.view(), false);
  control.wheel(3.0, {10.0, 10.0}, std::nullopt);
  EXPECT_GT(flySpeed(control.view(), false), 1.5 * before);
  EXPECT_EQ(control.view().eye, View{}.eye);
  control.wheel(-3.0, {10.0, 10.0}, std::nullopt);
  EXPECT_NEAR(flySpeed(control.view(), false), before, 1e-9);
  control.wheel(-1000.0, {10.0, 10.0}, std::nullopt);
  EXPECT_GT(flySpeed(control.view(), false), 0.0);
}

TEST(CameraControl, MovesAlikeAtEveryScaleFromAStatueToACountry) {
  std::mt19937 random(12);
  for (int i = 0; i < 100; ++i) {
    View view = randomView(random);
    const glm::dvec3 origin = view.target;
    view.eye -= origin, view.target -= origin;
    const glm::dvec2 from = randomPixel(random, view), to = randomPixel(random, view);
    const glm::dvec3 point = worldPoint(view, from, 30.0);
    const Box box{point - 10.0, point + 10.0};
    for (const double scale : {1e-2, 1.0, 1e4}) {
      View large = view;
      large.eye *= scale, large.target *= scale, large.orthographicHeight *= scale, large.nearPlane *= scale;
      const auto same = [&](const View& a, const View& b) {
        EXPECT_LT(glm::distance(a.eye * scale, b.eye), 1e-6 * scale);
        EXPECT_LT(glm::distance(a.target * scale, b.target), 1e-6 * scale);
      };
      FlyInput keys;
      keys.forward = 1, keys.right = -1;
      const Box largeBox{box.min * scale, box.max * scale};
      same(flown(view, keys, 0.2), flown(large, keys, 0.2));
      same(zoomed(view, point, 0.85), zoomed(large, point * scale, 0.85));
      same(panned(view, 30.0, to - from), panned(large, 30.0 * scale, to - from));
      same(orbited(view, point, to - from), orbited(large, point * scale, to - from));
      same(slid(view, point, to), slid(large, point * scale, to));
      same(approached(view, point), approached(large, point * scale));
      same(paced(view, 2.0), paced(large, 2.0));
      same(framed(view, box), framed(large, largeBox));
      same(standardView(view, box, StandardView::side), standardView(large, largeBox, StandardView::side));
    }
  }
}

TEST(CameraControl, FlyingForASecondIsTheSameWhateverTheFrameRate) {
  FlyInput keys;
  keys.forward = 1, keys.up = -1, keys.fast = true;
  View start;
  start.eye = {100.0, 20.0, 30.0};
  const View once = flown(start, keys, 1.0);
  for (const int frames : {2, 30, 144}) {
    CameraControl control(start);
    for (int i = 0; i < frames; ++i) control.fly(keys, 1.0 / frames);
    EXPECT_LT(glm::distance(control.view().eye, once.eye), 1e-6);
  }
}

TEST(CameraControl, ASegmentIsCutAtTheNearPlaneAndStaysOnItsLine) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> place(-30.0, 30.0);
  int cut = 0;
  for (int round = 0; round < 500; ++round) {
    View view;
    view.eye = {place(random), place(random), place(random)};
    view.target = {place(random), place(random), place(random)};
    const glm::dvec3 a(place(random), place(random), place(random)), b(place(random), place(random), place(random));
    const bool before[2] = {depthOf(view, a) >= view.nearPlane, depthOf(view, b) >= view.nearPlane};
    const auto segment = segmentOnScreen(view, a, b);
    ASSERT_EQ(segment.has_value(), before[0] || before[1]);
    if (!segment) continue;
    if (before[0]) {
      EXPECT_LT(glm::distance(segment->first, pixelOf(view, a)), 1e-6);
    }
    if (before[1]) {
      EXPECT_LT(glm::distance(segment->second, pixelOf(view, b)), 1e-6);
    }
    if (before[0] == before[1]) continue;
    ++cut;
    // Another point of the visible part lies on the line on the screen too.
    const glm::dvec3 inside = before[0] ? a + 1e-3 * (b - a) : b + 1e-3 * (a - b);
    if (depthOf(view, inside) < view.nearPlane) continue;
    const glm::dvec2 along = glm::normalize(segment->second - segment->first);
    const glm::dvec2 off = pixelOf(view, inside) - segment->first;
    EXPECT_NEAR(along.x * off.y - along.y * off.x, 0.0, 1e-3 * (1.0 + glm::length(off)));
  }
  EXPECT_GT(cut, 50);
}

}  // namespace
}  // namespace strata
