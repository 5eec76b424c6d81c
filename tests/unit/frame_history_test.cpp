#include "viewer/window/frame_history.h"

#include <gtest/gtest.h>

namespace strata {
namespace {

using std::chrono::milliseconds;

TEST(FrameHistory, KeepsTheLastFramesOldestFirst) {
  FrameHistory history;
  const FrameHistory::Clock::time_point start{};
  EXPECT_EQ(history.latest(FrameHistory::Series::frameMs), 0.0);
  EXPECT_EQ(history.largest(FrameHistory::Series::frameMs), 0.0);
  for (int i = 0; i < 500; ++i) history.add(start + milliseconds(i), {.frameMs = i * 1.0}, {});
  const auto frames = history.series(FrameHistory::Series::frameMs);
  ASSERT_EQ(frames.size(), FrameHistory::kLength);
  EXPECT_EQ(frames.front(), 500.0f - FrameHistory::kLength);
  EXPECT_EQ(frames.back(), 499.0f);
  EXPECT_EQ(history.latest(FrameHistory::Series::frameMs), 499.0);
  EXPECT_EQ(history.largest(FrameHistory::Series::frameMs), 499.0);
}

TEST(FrameHistory, TheDiskRateIsBytesOverTimeHoweverUnevenTheFramesAre) {
  FrameHistory history;
  FrameHistory::Clock::time_point now{};
  StreamerStats stats;
  for (int i = 0; i < 400; ++i) {
    const milliseconds step(i % 7 == 0 ? 90 : 3);
    now += step;
    stats.bytesRead += static_cast<std::uint64_t>(step.count()) * 20'000;  // 20 MB a second
    history.add(now, {}, stats);
  }
  EXPECT_NEAR(history.latest(FrameHistory::Series::readBytesPerSecond), 20e6, 1e3);
  for (int i = 0; i < 20; ++i) history.add(now += milliseconds(100), {}, stats);
  EXPECT_EQ(history.latest(FrameHistory::Series::readBytesPerSecond), 0.0);
}

TEST(FrameHistory, TheHitRateIsThatOfTheLastWindowInWhichNodesWereWanted) {
  FrameHistory history;
  FrameHistory::Clock::time_point now{};
  StreamerStats stats;
  history.add(now, {}, stats);
  EXPECT_EQ(history.latest(FrameHistory::Series::hitRate), 1.0);
  stats.cacheHits = 30;
  stats.cacheMisses = 10;
  history.add(now += milliseconds(600), {}, stats);
  EXPECT_NEAR(history.latest(FrameHistory::Series::hitRate), 0.75, 1e-6);
  history.add(now += milliseconds(600), {}, stats);
  EXPECT_NEAR(history.latest(FrameHistory::Series::hitRate), 0.75, 1e-6);
}

}  // namespace
}  // namespace strata
