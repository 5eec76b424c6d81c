// Streamers whose every function is called at once, to find races (under ThreadSanitizer) and deadlocks. No test looks
// at times.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <random>
#include <set>
#include <thread>

#include "lod/load_queue.h"
#include "lod/node_decoder.h"
#include "lod/node_reader.h"
#include "lod/streamer.h"
#include "tests/support/lod_store.h"

namespace strata {
namespace {

using namespace std::chrono_literals;
using test::makeStore;
using test::makeTerrain;
using test::Terrain;

const Terrain& terrain() {
  static const Terrain made = makeTerrain({.levels = 5, .side = 12, .cubeBits = 18}, true);
  return made;
}

StreamerOptions eightNodes(int loaders) {
  StreamerOptions options;
  options.cacheBytes = 8 * nodeBytesBound(terrain().hierarchy.nodes[0], terrain().info);
  options.loaderThreads = loaders;
  return options;
}

View randomView(std::mt19937& random) {
  const auto in = [&random](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  View view = test::viewOfTerrain(terrain().info, in(0, 1), in(0, 1), std::exp(in(1.0, 4.5)));
  view.target += glm::dvec3(in(-30, 30), in(-30, 30), in(-10, 10));
  return view;
}

/// Reads everything that is to be drawn, as a rasterizer would. A torn or recycled node does not add up.
std::uint64_t draw(const RenderList& list) {
  std::set<std::uint64_t> keys;
  std::uint64_t sum = 0;
  for (const RenderItem& item : list.items) {
    EXPECT_TRUE(item.node->key.isRoot() || keys.contains(item.node->key.parent().code));
    keys.insert(item.node->key.code);
    EXPECT_LE(item.pointCount, item.node->pointCount());
    EXPECT_EQ(item.node->colour.size(), item.node->pointCount());
    for (std::uint32_t i = 0; i < item.pointCount; ++i) sum += item.node->position[0][i] + item.node->colour[i];
  }
  return sum;
}

TEST(StreamerStress, RandomViewsWithACacheOfEightNodes) {
  for (const int loaders : {1, 3}) {
    std::mt19937 random(static_cast<unsigned>(loaders));
    const StreamerOptions options = eightNodes(loaders);
    Streamer streamer(makeStore(terrain()), options);
    for (int frame = 0; frame < 800; ++frame) {
      if (frame % 3 == 0) streamer.setView(randomView(random));
      draw(streamer.beginFrame());
      ASSERT_LE(streamer.stats().peakResidentBytes, options.cacheBytes);
      const bool waits = frame % 10 == 9;
      ASSERT_TRUE(!waits || streamer.waitUntilComplete(60s));
    }
    const StreamerStats stats = streamer.stats();
    EXPECT_GT(stats.nodesLoaded, 100u);
    EXPECT_GT(stats.evictions, 50u);
  }
}

TEST(StreamerStress, ViewsAndOptionsFromOtherThreads) {
  Streamer streamer(makeStore(terrain()), eightNodes(2));
  {
    std::vector<std::jthread> drivers;
    for (unsigned i = 0; i < 3; ++i)
      drivers.emplace_back([&streamer, i](std::stop_token stop) {
        std::mt19937 random(i);
        do {  // once at least: without a view there is nothing to complete
          streamer.setView(randomView(random));
          SelectionOptions options;
          options.pointsPerPixel = 0.25 * static_cast<double>(1 + random() % 8);
          streamer.setSelection(options);
          streamer.stats();
          streamer.complete();
          std::this_thread::yield();
        } while (!stop.stop_requested());
      });
    for (int frame = 0; frame < 1500; ++frame) draw(streamer.beginFrame());
  }
  EXPECT_TRUE(streamer.waitUntilComplete(60s)) << "once the views stand still";
}

TEST(StreamerStress, SourcesThatFailReadGarbageOrEndEarly) {
  for (unsigned seed = 0; seed < 4; ++seed) {
    Terrain damaged = terrain();
    std::mt19937 random(seed);
    for (int i = 0; i < 200; ++i)
      damaged.points[random() % damaged.points.size()] ^= static_cast<std::byte>(1 + random() % 255);
    if (seed % 2 == 1) damaged.points.resize(damaged.points.size() / 2);
    StreamerOptions options = eightNodes(2);
    if (seed >= 2) options.cacheBytes = std::uint64_t{1} << 30;
    Streamer streamer(makeStore(damaged,
                                [seed](std::uint64_t read) {
                                  if (read % (3 + seed) == 1) throw Error("points.bin", "unreadable");
                                }),
                      options);
    for (int frame = 0; frame < 300; ++frame) {
      if (frame % 5 == 0) streamer.setView(randomView(random));
      draw(streamer.beginFrame());
    }
    EXPECT_TRUE(streamer.waitUntilComplete(60s));
    EXPECT_GT(streamer.stats().failures, 0u);
  }
}

TEST(StreamerStress, ConstructAndDestroyAHundredTimes) {
  std::mt19937 random(9);
  std::chrono::steady_clock::duration longest{};
  for (int i = 0; i < 100; ++i) {
    auto streamer = std::make_unique<Streamer>(makeStore(terrain()), eightNodes(1 + i % 4));
    if (i % 3 != 0) streamer->setView(randomView(random));
    for (int frame = 0; frame < i % 7; ++frame) draw(streamer->beginFrame());
    const auto start = std::chrono::steady_clock::now();
    streamer.reset();
    longest = std::max(longest, std::chrono::steady_clock::now() - start);
  }
  RecordProperty("longest_stop_us", static_cast<int>(longest / 1us));
}

TEST(StreamerStress, StopsAHundredTimesWhileReadsAreBlocked) {
  struct Gate {
    std::mutex mutex;
    std::condition_variable opened;
    bool open = false;
    std::atomic<int> waiting{0};
  };
  const auto gate = std::make_shared<Gate>();
  const auto store = makeStore(terrain(), [gate](std::uint64_t) {
    ++gate->waiting;
    std::unique_lock lock(gate->mutex);
    gate->opened.wait(lock, [&] { return gate->open; });
  });
  std::mt19937 random(10);
  std::chrono::steady_clock::duration stopping{};
  for (int i = 0; i < 100; ++i) {
    const int waiting = gate->waiting;
    auto streamer = std::make_unique<Streamer>(store, eightNodes(1 + i % 3));
    streamer->setView(test::viewOfTerrain(terrain().info, 0.5, 0.3, 60.0));
    while (gate->waiting == waiting) std::this_thread::yield();
    const auto start = std::chrono::steady_clock::now();
    streamer.reset();
    stopping += std::chrono::steady_clock::now() - start;
  }
  EXPECT_LT(stopping / 100, 100ms) << "what each may take, here of their mean: the machine may be busy";
  EXPECT_GE(readersFinishingLater(), 100u);
  {
    const std::lock_guard lock(gate->mutex);
    gate->open = true;
  }
  gate->opened.notify_all();
  while (readersFinishingLater() > 0) std::this_thread::yield();
}

TEST(StreamerStress, ASlowDiskWhileFlying) {
  std::atomic<bool> quick{false};
  Streamer streamer(makeStore(terrain(),
                              [&quick](std::uint64_t) {
                                // A disk, not a test's wait: 5 ms a read.
                                if (!quick) std::this_thread::sleep_for(5ms);
                              }),
                    eightNodes(2));
  std::mt19937 random(3);
  for (int frame = 0; frame < 2000; ++frame) {
    if (frame % 4 == 0) streamer.setView(randomView(random));
    draw(streamer.beginFrame());
  }
  quick = true;
  EXPECT_TRUE(streamer.waitUntilComplete(60s));
}

TEST(LoadQueueStress, NoNodeIsInTwoHandsAtOnce) {
  LoadQueue queue;
  std::vector<std::atomic<int>> hands(64);
  std::atomic<int> taken{0};
  {
    std::vector<std::jthread> loaders;
    for (int i = 0; i < 4; ++i)
      loaders.emplace_back([&, i](std::stop_token stop) {
        while (const auto request = queue.pop(stop)) {
          EXPECT_EQ(hands[request->node].fetch_add(1), 0);
          ++taken;
          std::this_thread::yield();
          EXPECT_EQ(hands[request->node].fetch_sub(1), 1);
          if (i % 2 == 0)
            queue.finish(request->node);
          else
            queue.release(request->node);
        }
      });
    std::mt19937 random(4);
    std::vector<LoadRequest> requests;
    while (taken < 3000) {
      for (std::uint32_t node = 0; node < 64; ++node)
        if (random() % 2 == 0) requests.push_back({node, Precision::low10, static_cast<float>(random() % 100)});
      queue.replace(requests);
    }
    queue.stop();
  }
  EXPECT_EQ(queue.inFlight(), 0u);
}

}  // namespace
}  // namespace strata
