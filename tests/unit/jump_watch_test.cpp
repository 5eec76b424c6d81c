#include "viewer/bench/jump_watch.h"

#include <gtest/gtest.h>

namespace strata {
namespace {

View viewFrom(double x) {
  View view;
  view.eye = {x, 0.0, 0.0};
  view.target = {x, 1.0, 0.0};
  return view;
}

RenderList listOf(const View& view, std::size_t drawn, std::uint32_t missing, std::uint32_t coarse = 0) {
  RenderList list;
  list.view = view;
  list.items.resize(drawn);
  list.missingNodes = missing;
  list.coarseNodes = coarse;
  return list;
}

TEST(JumpWatch, TellsWhenEachShareOfTheDetailWasFirstInAFrame) {
  JumpWatch watch;
  const View view = viewFrom(0.0);
  watch.begin(0.0, 100.0);
  watch.look(view);
  EXPECT_EQ(watch.see(listOf(view, 0, 10), 110.0), 0.0);
  EXPECT_DOUBLE_EQ(watch.see(listOf(view, 79, 21), 120.0), 0.79);
  EXPECT_DOUBLE_EQ(watch.see(listOf(view, 80, 20), 130.0), 0.80);
  EXPECT_DOUBLE_EQ(watch.see(listOf(view, 50, 50), 140.0), 0.50);  // what was reached stays reached
  EXPECT_DOUBLE_EQ(watch.see(listOf(view, 96, 4), 150.0), 0.96);
  EXPECT_DOUBLE_EQ(watch.see(listOf(view, 100, 0, 1), 160.0), 0.99);  // there, but not as finely as wanted
  EXPECT_DOUBLE_EQ(watch.see(listOf(view, 100, 0), 170.0), 1.0);
  const std::vector<JumpRecord> jumps = watch.take();
  ASSERT_EQ(jumps.size(), 1u);
  EXPECT_DOUBLE_EQ(jumps[0].reachedMs[0], 30.0);
  EXPECT_DOUBLE_EQ(jumps[0].reachedMs[1], 50.0);
  EXPECT_DOUBLE_EQ(jumps[0].reachedMs[2], 70.0);
}

TEST(JumpWatch, AListChosenBeforeTheJumpHasNoDetail) {
  JumpWatch watch;
  const View before = viewFrom(0.0), after = viewFrom(50.0), next = viewFrom(51.0);
  watch.begin(0.0, 0.0);
  watch.look(before);
  EXPECT_EQ(watch.see(listOf(before, 5, 0), 10.0), 1.0);
  watch.begin(2.0, 2000.0);
  watch.look(after);
  EXPECT_EQ(watch.see(listOf(before, 5, 0), 2030.0), 0.0);
  watch.look(next);
  EXPECT_EQ(watch.see(listOf(after, 9, 1), 2060.0), 0.9);  // of the frame before, but of this place
  EXPECT_EQ(watch.see(listOf(next, 0, 0), 2090.0), 1.0);   // nothing is wanted there
  const std::vector<JumpRecord> jumps = watch.take();
  ASSERT_EQ(jumps.size(), 2u);
  EXPECT_EQ(jumps[1].t, 2.0);
  EXPECT_DOUBLE_EQ(jumps[1].reachedMs[0], 60.0);
  EXPECT_DOUBLE_EQ(jumps[1].reachedMs[1], 90.0);
  EXPECT_DOUBLE_EQ(jumps[1].reachedMs[2], 90.0);
}

TEST(JumpWatch, WhatIsNotReachedBeforeTheNextJumpStaysSo) {
  JumpWatch watch;
  const View first = viewFrom(0.0), second = viewFrom(9.0);
  watch.begin(0.0, 0.0);
  watch.look(first);
  watch.see(listOf(first, 9, 1), 10.0);
  watch.begin(1.0, 1000.0);
  watch.look(second);
  watch.see(listOf(second, 1, 0), 1005.0);
  const std::vector<JumpRecord> jumps = watch.take();
  EXPECT_EQ(jumps[0].reachedMs[0], 10.0);
  EXPECT_EQ(jumps[0].reachedMs[2], -1.0);
  EXPECT_EQ(jumps[1].reachedMs[2], 5.0);
}

TEST(MedianJumps, TakesEachShareByItselfAndWhatHalfOfTheRunsNeverReachedAsNotReached) {
  const std::vector<JumpRecord> runs[3] = {{{0.0, {10.0, 30.0, -1.0}}, {1.0, {5.0, 5.0, 5.0}}},
                                           {{0.0, {20.0, 20.0, -1.0}}, {1.0, {6.0, 6.0, -1.0}}},
                                           {{0.0, {30.0, 25.0, 99.0}}, {1.0, {7.0, -1.0, 9.0}}}};
  const std::vector<JumpRecord> median = medianJumps(runs);
  ASSERT_EQ(median.size(), 2u);
  EXPECT_EQ(median[0].reachedMs[0], 20.0);
  EXPECT_EQ(median[0].reachedMs[1], 25.0);
  EXPECT_EQ(median[0].reachedMs[2], -1.0);
  EXPECT_EQ(median[1].t, 1.0);
  EXPECT_EQ(median[1].reachedMs[1], 6.0);
  EXPECT_EQ(median[1].reachedMs[2], 9.0);
  EXPECT_EQ(medianJumps(std::span(runs).first(1))[0].reachedMs[1], 30.0);
  EXPECT_TRUE(medianJumps({}).empty());
}

}  // namespace
}  // namespace strata
