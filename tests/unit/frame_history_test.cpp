#include "viewer/window/frame_history.h"

#include <gtest/gtest.h>

namespace strata {
namespace {

using std::chrono::milliseconds;

TEST(Monitor, KeepsTheLastFramesOldestFirst) {
  Monitor monitor;
  const Monitor::Clock::time_point start{};
  EXPECT_EQ(monitor.latest(Monitor::Series::frameMs), 0.0);
  EXPECT_EQ(monitor.largest(Monitor::Series::frameMs), 0.0);
  for (int i = 0; i < 500; ++i) monitor.add(start + milliseconds(i), {.frameMs = i * 1.0}, {});
  const auto frames = monitor.series(Monitor::Series::frameMs);
  ASSERT_EQ(frames.size(), Monitor::kLength);
  EXPECT_EQ(frames.front(), 500.0f - Monitor::kLength);
  EXPECT_EQ(frames.back(), 499.0f);
  EXPECT_EQ(monitor.latest(Monitor::Series::frameMs), 499.0);
  EXPECT_EQ(monitor.largest(Monitor::Series::frameMs), 499.0);
}

TEST(Monitor, TheDiskRateIsBytesOverTimeHoweverUnevenTheFramesAre) {
  Monitor monitor;
  Monitor::Clock::time_point now{};
  StreamerStats stats;
  for (int i = 0; i < 400; ++i) {
    const milliseconds step(i % 7 == 0 ? 90 : 3);
    now += step;
    stats.bytesRead += static_cast<std::uint64_t>(step.count()) * 20'000;  // 20 MB a second
    monitor.add(now, {}, stats);
  }
  EXPECT_NEAR(monitor.latest(Monitor::Series::readBytesPerSecond), 20e6, 1e3);
  for (int i = 0; i < 20; ++i) monitor.add(now += milliseconds(100), {}, stats);
  EXPECT_EQ(monitor.latest(Monitor::Series::readBytesPerSecond), 0.0);
}

TEST(Monitor, TheHitRateIsThatOfTheLastWindowInWhichAnythingWasWanted) {
  Monitor monitor;
  Monitor::Clock::time_point now{};
  StreamerStats stats;
  monitor.add(now, {}, stats);
  EXPECT_EQ(monitor.latest(Monitor::Series::hitRate), 1.0);
  stats.cacheHits = 30;
  stats.cacheMisses = 10;
  monitor.add(now += milliseconds(600), {}, stats);
  EXPECT_NEAR(monitor.latest(Monitor::Series::hitRate), 0.75, 1e-6);
  monitor.add(now += milliseconds(600), {}, stats);
  EXPECT_NEAR(monitor.latest(Monitor::Series::hitRate), 0.75, 1e-6);
}

}  // namespace
}  // namespace strata
