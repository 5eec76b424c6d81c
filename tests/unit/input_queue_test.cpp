#include "viewer/window/input_queue.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace strata {
namespace {

using Kind = InputEvent::Kind;

InputEvent cursor(double x, double y) { return {.kind = Kind::cursor, .place = {x, y}}; }
InputEvent button(bool down, double after = 0.0, double before = 0.0) {
  return {.kind = Kind::button, .down = down, .after = after, .before = before};
}
InputEvent key(int code, bool down) { return {.kind = Kind::key, .code = code, .down = down}; }

std::vector<std::vector<InputEvent>> framesOf(const std::vector<InputEvent>& events) {
  InputQueue queue;
  for (const InputEvent& event : events) queue.add(event);
  std::vector<std::vector<InputEvent>> frames;
  while (!queue.empty()) frames.push_back(queue.takeFrame());
  return frames;
}

TEST(InputQueue, AClickWithinOneFrameIsSeenToGoDownAndUpWhereItWasMade) {
  const auto frames = framesOf({cursor(5, 5), button(true), button(false), cursor(90, 90)});
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames[0].size(), 2u);
  EXPECT_TRUE(frames[0][1].down);
  EXPECT_FALSE(frames[1][0].down);
  EXPECT_EQ(frames[2][0].place, glm::dvec2(90.0, 90.0));
}

TEST(InputQueue, ADragWithinOneFrameReachesItsEndBeforeItIsLetGo) {
  const auto frames = framesOf({cursor(5, 5), button(true), cursor(50, 5), cursor(90, 5), button(false)});
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames[1].back().place, glm::dvec2(90.0, 5.0));
  EXPECT_EQ(frames[2][0].kind, Kind::button);
}

TEST(InputQueue, ATappedKeyIsSeenToGoDownAndAShortcutGoesDownInOneFrame) {
  EXPECT_EQ(framesOf({key(1, true), key(1, false)}).size(), 2u);
  const auto frames = framesOf({key(9, true), key(1, true), key(1, false), key(9, false)});
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_EQ(frames[0].size(), 2u);
}

TEST(InputQueue, EveryEventComesOnceAndInOrderAndNoFrameIsEmpty) {
  std::mt19937 random(7);
  for (int round = 0; round < 200; ++round) {
    std::vector<InputEvent> events(random() % 30);
    for (std::size_t i = 0; i < events.size(); ++i) {
      events[i].kind = static_cast<Kind>(random() % 5);
      events[i].code = static_cast<int>(random() % 3);
      events[i].down = random() % 2 == 0;
      events[i].scancode = static_cast<int>(i);
    }
    int next = 0;
    for (const auto& frame : framesOf(events)) {
      EXPECT_FALSE(frame.empty());
      EXPECT_LE(std::count_if(frame.begin(), frame.end(), [](const InputEvent& e) { return e.kind == Kind::button; }),
                1);
      for (const InputEvent& event : frame) EXPECT_EQ(event.scancode, next++);
    }
    EXPECT_EQ(next, static_cast<int>(events.size()));
  }
}

TEST(InputQueue, TwoClicksAreADoubleClickEvenInSlowFrames) {
  const auto second = [](double after, double before, glm::dvec2 moved = {0.0, 0.0}) {
    InputQueue queue;
    queue.add(cursor(10, 10));
    queue.add(button(true, 0.0, 1.0));
    queue.add(button(false, 0.0, 1.0));
    queue.add(cursor(10 + moved.x, 10 + moved.y));
    queue.add(button(true, after, before));
    std::vector<InputEvent> all;
    while (!queue.empty())
      for (const InputEvent& event : queue.takeFrame()) all.push_back(event);
    EXPECT_FALSE(all[1].doubleClick);
    return all.back().doubleClick;
  };
  EXPECT_TRUE(second(0.0, 1.0));   // in the same frame
  EXPECT_TRUE(second(1.0, 2.0));   // in the next frame, which lasts a second
  EXPECT_TRUE(second(1.2, 1.21));  // two fast frames
  EXPECT_FALSE(second(1.4, 1.41));
  EXPECT_FALSE(second(1.0, 1.1, {20.0, 0.0}));
}

TEST(InputQueue, AThirdClickBeginsAnew) {
  InputQueue queue;
  int doubles = 0;
  for (int i = 0; i < 3; ++i) queue.add(button(true)), queue.add(button(false));
  while (!queue.empty())
    for (const InputEvent& event : queue.takeFrame()) doubles += event.doubleClick ? 1 : 0;
  EXPECT_EQ(doubles, 1);
}

}  // namespace
}  // namespace strata
