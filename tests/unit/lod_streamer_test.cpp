#include "lod/streamer.h"

#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <set>
#include <thread>

#include "io/store/node_codec.h"
#include "lod/node_decoder.h"
#include "lod/node_reader.h"
#include "tests/support/lod_store.h"

namespace strata {
namespace {

using namespace std::chrono_literals;
using test::makeStore;
using test::makeTerrain;
using test::Terrain;
using test::viewOfTerrain;

constexpr auto kLong = 60s;

const Terrain& terrain() {
  static const Terrain made = makeTerrain({.levels = 5, .cubeBits = 18}, true);
  return made;
}

View lookDown(double height = 60.0) { return viewOfTerrain(terrain().info, 0.5, 0.3, height); }

/// Checks what holds for every list: parents are in it, nodes are in order, prefixes are no longer than nodes.
void expectSound(const RenderList& list) {
  std::set<std::uint64_t> keys;
  std::uint64_t points = 0;
  std::uint64_t last = 0;
  for (const RenderItem& item : list.items) {
    ASSERT_NE(item.node, nullptr);
    EXPECT_GT(item.node->key.code, last) << "breadth-first order";
    last = item.node->key.code;
    EXPECT_TRUE(item.node->key.isRoot() || keys.contains(item.node->key.parent().code)) << item.node->key.text();
    keys.insert(item.node->key.code);
    EXPECT_LE(item.pointCount, item.node->pointCount());
    points += item.pointCount;
  }
  EXPECT_EQ(points, list.pointCount);
}

/// A gate in a byte source, at which reads wait until it is opened.
class Gate {
 public:
  void open() {
    {
      const std::lock_guard lock(mutex_);
      open_ = true;
    }
    changed_.notify_all();
  }
  void pass() {
    std::unique_lock lock(mutex_);
    ++waiting_;
    changed_.notify_all();
    changed_.wait(lock, [this] { return open_; });
  }
  void awaitReader() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return waiting_ > 0; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool open_ = false;
  int waiting_ = 0;
};

TEST(Streamer, LoadsAllThatAViewWants) {
  Streamer streamer(makeStore(terrain()), {});
  EXPECT_FALSE(streamer.complete()) << "there is no view yet";
  streamer.setView(lookDown());
  ASSERT_TRUE(streamer.waitUntilComplete(kLong));
  EXPECT_TRUE(streamer.complete());
  const RenderList& list = streamer.beginFrame();
  expectSound(list);
  EXPECT_EQ(list.missingNodes, 0u);
  EXPECT_EQ(list.view, lookDown());

  Selection selection;
  selectNodes(terrain().hierarchy, lookDown(), {}, selection);
  EXPECT_GT(selection.nodes.size(), 20u);
  EXPECT_EQ(list.items.size(), selection.nodes.size());
  EXPECT_EQ(list.pointCount, selection.pointCount);

  const StreamerStats stats = streamer.stats();
  EXPECT_EQ(stats.nodesLoaded, selection.nodes.size());
  EXPECT_EQ(stats.cacheMisses, selection.nodes.size());
  EXPECT_EQ(stats.cacheHits, 0u);
  EXPECT_EQ(stats.failures, 0u);
  EXPECT_EQ(stats.queueLength, 0u);
  EXPECT_EQ(stats.residentNodes, selection.nodes.size());
}

TEST(Streamer, ReadsJustTheBytesThatThePrecisionNeeds) {
  StreamerOptions options;
  options.together.bytes = 0;  // each node by itself
  Streamer streamer(makeStore(terrain()), options);
  streamer.setView(lookDown());
  ASSERT_TRUE(streamer.waitUntilComplete(kLong));
  Selection selection;
  selectNodes(terrain().hierarchy, lookDown(), {}, selection);
  std::uint64_t bytes = 0;
  for (const SelectedNode& selected : selection.nodes) {
    const NodeRecord& record = terrain().hierarchy.nodes[selected.node];
    bytes += drawBytes(record, usefulPrecision(record, selected.precision));
  }
  EXPECT_EQ(streamer.stats().bytesRead, bytes);
}

TEST(Streamer, ReadsNeighboursTogether) {
  StreamerOptions options;
  options.together.waste = 10.0f;  // the nodes are so small that what is left of them unread is more
  Streamer streamer(makeStore(terrain()), options);
  streamer.setView(lookDown());
  ASSERT_TRUE(streamer.waitUntilComplete(kLong));
  EXPECT_EQ(streamer.beginFrame().missingNodes, 0u);
  EXPECT_LT(streamer.stats().reads, streamer.stats().nodesLoaded / 2);
}

TEST(Streamer, LooksAheadOnlyWhenNothingIsMissingHere) {
  Streamer streamer(makeStore(terrain()), {});
  const View here = lookDown(), there = viewOfTerrain(terrain().info, 0.5, 0.6, 20.0);
  streamer.setView(here, there);
  ASSERT_TRUE(streamer.waitUntilComplete(kLong));
  EXPECT_EQ(streamer.beginFrame().missingNodes, 0u);
  Selection ahead;
  selectNodes(terrain().hierarchy, there, {}, ahead);
  Selection now;
  selectNodes(terrain().hierarchy, here, {}, now);
  std::set<std::uint32_t> both;
  for (const SelectedNode& node : ahead.nodes) both.insert(node.node);
  for (const SelectedNode& node : now.nodes) both.insert(node.node);
  while (streamer.stats().residentNodes < both.size()) streamer.beginFrame();
  EXPECT_GT(streamer.stats().nodesAhead, 0u);
  const std::uint64_t misses = streamer.stats().cacheMisses;
  streamer.setView(there);
  ASSERT_TRUE(streamer.waitUntilComplete(kLong));
  EXPECT_EQ(streamer.stats().cacheMisses, misses) << "all of it was there already";
}

TEST(Streamer, FindsEverythingResidentWhenAViewComesBack) {
  Streamer streamer(makeStore(terrain()), {});
  streamer.setView(lookDown());
  ASSERT_TRUE(streamer.waitUntilComplete(kLong));
  const std::uint64_t loaded = streamer.stats().nodesLoaded;
  View away = lookDown();
  away.target = away.eye + glm::dvec3(0, 0, 1);
  streamer.setView(away);
  ASSERT_TRUE(streamer.waitUntilComplete(kLong));
  EXPECT_TRUE(streamer.beginFrame().items.empty());
  streamer.setView(lookDown());
  ASSERT_TRUE(streamer.waitUntilComplete(kLong));
  EXPECT_EQ(streamer.stats().nodesLoaded, loaded);
  EXPECT_EQ(streamer.stats().cacheHits, loaded);
  EXPECT_DOUBLE_EQ(streamer.stats().hitRate(), 0.5);
}

TEST(Streamer, FetchesFinerCoordinatesWhenTheEyeComesNear) {
  const Terrain large = makeTerrain({.levels = 1, .side = 64, .cubeBits = 16}, true);
  Streamer streamer(makeStore(large), {});
  streamer.setView(viewOfTerrain(large.info, 0.5, 0.2, 400.0));
  ASSERT_TRUE(streamer.waitUntilComplete(kLong));
  EXPECT_EQ(streamer.beginFrame().items.at(0).node->loadedPlanes(), 1);
  streamer.setView(viewOfTerrain(large.info, 0.5, 0.2, 4.0));
  ASSERT_TRUE(streamer.waitUntilComplete(kLong));
  EXPECT_EQ(streamer.beginFrame().items.at(0).node->loadedPlanes(), 2);
  EXPECT_EQ(streamer.stats().nodesLoaded, 2u);
  EXPECT_EQ(streamer.stats().residentNodes, 1u);
}

TEST(Streamer, ReadsOnlyTheRestOfANodeThatIsNeededInMoreDetail) {
  const Terrain large = makeTerrain({.levels = 1, .side = 64, .cubeBits = 16}, true);
  const NodeRecord& record = large.hierarchy.nodes[0];
  Streamer streamer(makeStore(large), {});
  streamer.setView(viewOfTerrain(large.info, 0.5, 0.2, 400.0));
  ASSERT_TRUE(streamer.waitUntilComplete(kLong));
  EXPECT_EQ(streamer.stats().bytesRead, record.drawBytes[0]);
  streamer.setView(viewOfTerrain(large.info, 0.5, 0.2, 4.0));
  ASSERT_TRUE(streamer.waitUntilComplete(kLong));
  EXPECT_EQ(streamer.stats().bytesRead, record.drawBytes[1]);

  // The same as what is decoded at once.
  const std::shared_ptr<const NodeData> node = streamer.beginFrame().items.at(0).node;
  NodeData whole;
  readForDrawing(*makeStore(large), 0, Precision::medium20, whole);
  for (int plane = 0; plane < 3; ++plane) EXPECT_EQ(node->position[plane], whole.position[plane]);
  EXPECT_EQ(node->colour, whole.colour);
  EXPECT_EQ(node->intensity, whole.intensity);
}

TEST(Streamer, ReadsOnlyWhatIsShownAndTheRestWhenThatChanges) {
  StreamerOptions options;
  options.together.bytes = 0;  // each node by itself
  options.selection.shown.colour = ColourMode::rgb;
  const auto store = makeStore(terrain());
  Streamer streamer(store, options);
  // From afar the root alone is read. What it needed tells the next pass how much of each other node to ask for.
  streamer.setView(viewOfTerrain(terrain().info, 0.5, 0.3, 20000.0));
  ASSERT_TRUE(streamer.waitUntilComplete(kLong));
  ASSERT_EQ(streamer.stats().nodesLoaded, 1u);
  streamer.setView(lookDown());
  ASSERT_TRUE(streamer.waitUntilComplete(kLong));
  const std::uint64_t colours = streamer.stats().bytesRead;
  std::uint64_t without = 0;
  for (const RenderItem& item : streamer.beginFrame().items) {
    EXPECT_EQ(item.node->colour.size(), item.node->pointCount());
    for (const NodeRecord& record : terrain().hierarchy.nodes)
      if (record.key == item.node->key.code) without += record.drawBytes[item.node->loadedPlanes() - 1];
  }
  EXPECT_LT(colours, without);

  options.selection.shown.colour = ColourMode::intensity;
  streamer.setSelection(options.selection);
  ASSERT_TRUE(streamer.waitUntilComplete(kLong));
  for (const RenderItem& item : streamer.beginFrame().items) {
    EXPECT_EQ(item.node->intensity.size(), item.node->pointCount());
    EXPECT_EQ(item.node->colour.size(), item.node->pointCount());
  }
  EXPECT_LE(streamer.stats().bytesRead, without) << "nothing is read twice";
}

TEST(Streamer, ReadsNormalsWhereTheyAreAskedForAndThere) {
  for (const bool has : {false, true}) {
    const Terrain made = makeTerrain({.levels = 5, .cubeBits = 18, .normals = has}, true);
    StreamerOptions options;
    options.selection.shown.colour = ColourMode::rgb;
    Streamer streamer(makeStore(made), options);
    streamer.setView(viewOfTerrain(made.info, 0.5, 0.3, 60.0));
    ASSERT_TRUE(streamer.waitUntilComplete(kLong));
    for (const RenderItem& item : streamer.beginFrame().items) EXPECT_TRUE(item.node->normal.empty());
    const std::uint64_t without = streamer.stats().bytesRead;
    options.selection.shown.normals = true;
    streamer.setSelection(options.selection);
    ASSERT_TRUE(streamer.waitUntilComplete(kLong));
    for (const RenderItem& item : streamer.beginFrame().items) {
      EXPECT_EQ(item.node->normal.size(), has ? item.node->pointCount() : 0u);
      EXPECT_EQ(item.node->colour.size(), item.node->pointCount());
    }
    EXPECT_EQ(streamer.stats().bytesRead > without, has);
  }
}

TEST(Streamer, DrawsParentsWhileChildrenAreOnTheirWay) {
  Gate gate;
  // The root's payload is one read; everything after it waits.
  Streamer streamer(makeStore(terrain(),
                              [&](std::uint64_t read) {
                                if (read > 0) gate.pass();
                              }),
                    {});
  streamer.setView(lookDown());
  gate.awaitReader();
  while (streamer.beginFrame().items.empty()) EXPECT_FALSE(streamer.waitUntilComplete(5ms));
  const RenderList& list = streamer.beginFrame();
  ASSERT_EQ(list.items.size(), 1u);
  EXPECT_TRUE(list.items[0].node->key.isRoot());
  EXPECT_GT(list.missingNodes, 10u);
  gate.open();
  EXPECT_TRUE(streamer.waitUntilComplete(kLong));
  EXPECT_EQ(streamer.beginFrame().missingNodes, 0u);
}

TEST(Streamer, DoesNotLetABlockedDiskHoldUpTheFrame) {
  Gate gate;
  Streamer streamer(makeStore(terrain(), [&](std::uint64_t) { gate.pass(); }), {});
  streamer.setView(lookDown());
  gate.awaitReader();
  for (int frame = 0; frame < 1000; ++frame) {
    streamer.setView(lookDown(60.0 + 0.01 * frame));
    expectSound(streamer.beginFrame());
  }
  gate.open();
  EXPECT_TRUE(streamer.waitUntilComplete(kLong));
}

TEST(Streamer, RetriesANodeThatFailedOnce) {
  Streamer streamer(makeStore(terrain(),
                              [](std::uint64_t read) {
                                if (read == 3 || read == 10) throw Error("points.bin", "flaky");
                              }),
                    {});
  streamer.setView(lookDown());
  ASSERT_TRUE(streamer.waitUntilComplete(kLong));
  EXPECT_EQ(streamer.beginFrame().missingNodes, 0u);
  EXPECT_GT(streamer.stats().failures, 0u);
  EXPECT_EQ(streamer.stats().nodesGivenUp, 0u);
}

TEST(Streamer, WaitsBeforeItTriesAFailedNodeAgain) {
  StreamerOptions options;
  options.firstRetry = 80ms;
  std::atomic<bool> broken{true};
  Streamer streamer(makeStore(terrain(),
                              [&broken](std::uint64_t) {
                                if (broken) throw Error("points.bin", "unplugged");
                              }),
                    options);
  streamer.setView(lookDown());
  while (streamer.stats().failures == 0) streamer.waitUntilComplete(1ms);
  const auto failed = std::chrono::steady_clock::now();
  broken = false;
  ASSERT_TRUE(streamer.waitUntilComplete(kLong)) << "the pass after the wait starts by itself";
  EXPECT_GE(std::chrono::steady_clock::now() - failed, 40ms) << "the clock was read after the failure";
  EXPECT_EQ(streamer.beginFrame().missingNodes, 0u);
  EXPECT_EQ(streamer.stats().nodesGivenUp, 0u);
}

TEST(Streamer, GivesUpADamagedNodeAndDrawsItsParent) {
  Terrain damaged = terrain();
  const NodeRecord& broken = damaged.hierarchy.nodes[2];
  for (std::uint32_t i = 0; i < broken.payloadBytes; ++i) damaged.points[broken.offset + i] ^= std::byte{0x5a};
  Streamer streamer(makeStore(damaged), {});
  SelectionOptions fine;
  fine.pointsPerPixel = 1e6;
  streamer.setSelection(fine);
  streamer.setView(viewOfBox(damaged.info.rootCube(), {0.2, 0.3, -1.0}, 1920, 1080, 1.0));
  ASSERT_TRUE(streamer.waitUntilComplete(kLong)) << "what cannot be had is done without";
  const RenderList& list = streamer.beginFrame();
  expectSound(list);
  for (const RenderItem& item : list.items) EXPECT_FALSE(NodeKey{broken.key}.isAncestorOf(item.node->key));
  EXPECT_EQ(list.items.size(), 1u + 3 * 85u);
  EXPECT_EQ(list.missingNodes, 85u);
  const StreamerStats stats = streamer.stats();
  EXPECT_EQ(stats.failures, static_cast<std::uint64_t>(FailedNodes::kMaxAttempts));
  EXPECT_EQ(stats.nodesGivenUp, 1u);
}

TEST(Streamer, IsCompleteWithNothingWhenTheRootIsDamaged) {
  Streamer streamer(makeStore(terrain(), [](std::uint64_t) { throw Error("points.bin", "gone"); }), {});
  streamer.setView(lookDown());
  ASSERT_TRUE(streamer.waitUntilComplete(kLong));
  EXPECT_TRUE(streamer.beginFrame().items.empty());
  EXPECT_GT(streamer.beginFrame().missingNodes, 0u);
}

TEST(Streamer, KeepsWithinATinyCacheAndStillCompletes) {
  const NodeRecord& record = terrain().hierarchy.nodes[0];
  StreamerOptions options;
  options.cacheBytes = 8 * nodeBytesBound(record, terrain().info);
  Streamer streamer(makeStore(terrain()), options);
  for (const double x : {0.1, 0.9, 0.4, 0.6}) {
    streamer.setView(viewOfTerrain(terrain().info, x, x, 10.0));
    ASSERT_TRUE(streamer.waitUntilComplete(kLong));
    const RenderList& list = streamer.beginFrame();
    expectSound(list);
    EXPECT_GE(list.items.size(), 5u);
    EXPECT_LE(list.items.size(), 7u) << "one place is kept for a node that is being replaced";
    EXPECT_LE(streamer.stats().peakResidentBytes, options.cacheBytes);
  }
  EXPECT_GT(streamer.stats().evictions, 0u);
  EXPECT_GT(streamer.stats().overCapacity, 0u);
}

TEST(Streamer, DrawsNothingWithoutACache) {
  StreamerOptions options;
  options.cacheBytes = 0;
  Streamer streamer(makeStore(terrain()), options);
  streamer.setView(lookDown());
  ASSERT_TRUE(streamer.waitUntilComplete(kLong));
  EXPECT_TRUE(streamer.beginFrame().items.empty());
  EXPECT_EQ(streamer.stats().nodesLoaded, 0u);
}

TEST(Streamer, GivesTheSameListWithAnyNumberOfLoaders) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> first;
  for (const int loaders : {1, 2, 5}) {
    StreamerOptions options;
    options.loaderThreads = loaders;
    Streamer streamer(makeStore(terrain()), options);
    streamer.setView(lookDown());
    ASSERT_TRUE(streamer.waitUntilComplete(kLong));
    std::vector<std::pair<std::uint64_t, std::uint32_t>> items;
    for (const RenderItem& item : streamer.beginFrame().items) items.emplace_back(item.node->key.code, item.pointCount);
    if (first.empty()) first = items;
    EXPECT_EQ(items, first);
  }
}

TEST(Streamer, FollowsTheSelectionOptions) {
  Streamer streamer(makeStore(terrain()), {});
  streamer.setView(lookDown());
  ASSERT_TRUE(streamer.waitUntilComplete(kLong));
  SelectionOptions options;
  options.pointBudget = 1000;
  streamer.setSelection(options);
  ASSERT_TRUE(streamer.waitUntilComplete(kLong));
  EXPECT_EQ(streamer.beginFrame().pointCount, 1000u);
}

TEST(Streamer, EvictedMemoryIsUsedAgainWithoutTouchingWhatACallerStillHolds) {
  StreamerOptions options;
  options.cacheBytes = 8 * nodeBytesBound(terrain().hierarchy.nodes[0], terrain().info);
  Streamer streamer(makeStore(terrain()), options);
  streamer.setView(lookDown(20.0));
  ASSERT_TRUE(streamer.waitUntilComplete(kLong));
  const std::vector<RenderItem> kept = streamer.beginFrame().items;
  std::vector<NodeData> copies;
  for (const RenderItem& item : kept) copies.push_back(*item.node);
  for (int i = 0; i < 20; ++i) {
    streamer.setView(viewOfTerrain(terrain().info, 0.1 + 0.04 * i, 0.1, 20.0));
    ASSERT_TRUE(streamer.waitUntilComplete(kLong));
  }
  for (std::size_t i = 0; i < kept.size(); ++i) {
    EXPECT_EQ(kept[i].node->key, copies[i].key);
    EXPECT_EQ(kept[i].node->position[0], copies[i].position[0]);
    EXPECT_EQ(kept[i].node->colour, copies[i].colour);
  }
}

TEST(Streamer, StopsWhileLoadersWaitForBuffersOrWork) {
  for (const bool withView : {false, true}) {
    StreamerOptions options;
    options.loaderThreads = 3;
    auto streamer = std::make_unique<Streamer>(makeStore(terrain()), options);
    if (withView) {
      streamer->setView(lookDown());
      // Nobody takes the filled buffers: all loaders come to wait for an empty one.
      while (streamer->stats().nodesLoaded < 7) std::this_thread::yield();
    }
    const auto start = std::chrono::steady_clock::now();
    streamer.reset();
    RecordProperty("stop_us", static_cast<int>((std::chrono::steady_clock::now() - start) / 1us));
  }
}

TEST(Streamer, StopsWithoutWaitingForAReadThatDoesNotReturn) {
  const auto gate = std::make_shared<Gate>();
  StreamerOptions options;
  options.loaderThreads = 3;
  auto streamer = std::make_unique<Streamer>(makeStore(terrain(), [gate](std::uint64_t) { gate->pass(); }), options);
  streamer->setView(lookDown());
  gate->awaitReader();
  const auto start = std::chrono::steady_clock::now();
  streamer.reset();  // would never end if it waited for the reads
  RecordProperty("stop_us", static_cast<int>((std::chrono::steady_clock::now() - start) / 1us));
  EXPECT_GT(readersFinishingLater(), 0u);
  gate->open();
  while (readersFinishingLater() > 0) std::this_thread::yield();
}

TEST(Streamer, StopsWithinTheTimeOfAReadThatIsSlow) {
  for (int round = 0; round < 5; ++round) {
    // A disk, not a test's wait: 200 ms a read.
    auto streamer = std::make_unique<Streamer>(
        makeStore(terrain(), [](std::uint64_t) { std::this_thread::sleep_for(200ms); }), StreamerOptions{});
    streamer->setView(lookDown());
    while (streamer->stats().lodPasses == 0) std::this_thread::yield();
    std::this_thread::sleep_for(std::chrono::milliseconds(20 * round));  // somewhere in the read
    const auto start = std::chrono::steady_clock::now();
    streamer.reset();
    // Goal 20 ms, promised 100; a busy machine may take the processor away for as long, but not for the whole read.
    EXPECT_LT(std::chrono::steady_clock::now() - start, 150ms);
  }
}

}  // namespace
}  // namespace strata
