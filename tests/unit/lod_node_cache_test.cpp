#include "lod/node_cache.h"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <set>

namespace strata {
namespace {

constexpr std::uint32_t kNone = 0xffffffffu;
constexpr std::uint32_t kPoints = 1000;

std::shared_ptr<StreamedNode> makeNode(std::uint32_t points = kPoints, int planes = 1) {
  auto node = std::make_shared<StreamedNode>();
  for (int p = 0; p < planes; ++p) node->position[p].resize(points);
  return node;
}

const std::uint64_t kBytes = makeNode()->memoryBytes();

/// A cache over a small tree: 0 is the root, 1 and 2 its children, 3 and 4 children of 1, 5 and 6 of 2.
class NodeCacheTest : public testing::Test {
 protected:
  static constexpr std::uint32_t kParents[] = {kNone, 0, 0, 1, 1, 2, 2};

  NodeCache::Insertion add(NodeCache& cache, std::uint32_t node, int planes = 1) {
    return cache.insert(node, makeNode(kPoints, planes), out_);
  }
  std::vector<NodeCache::Pin> pin(NodeCache& cache, std::vector<std::uint32_t> nodes) {
    std::vector<NodeCache::Pin> pins;
    cache.pin(nodes, found_, pins);
    return pins;
  }
  void unpin(NodeCache& cache, const std::vector<NodeCache::Pin>& pins) {
    found_.clear();
    cache.unpin(pins, out_);
  }

  std::vector<NodeCache::Released> out_;
  std::vector<NodeCache::Data> found_;
};

using Insertion = NodeCache::Insertion;

TEST_F(NodeCacheTest, WhatWasInsertedIsFound) {
  NodeCache cache(10 * kBytes, kParents);
  EXPECT_EQ(add(cache, 0), Insertion::inserted);
  EXPECT_TRUE(cache.contains(0));
  EXPECT_FALSE(cache.contains(1));
  const auto pins = pin(cache, {0, 1});
  EXPECT_EQ(pins.size(), 1u);
  EXPECT_NE(found_.at(0), nullptr);
  EXPECT_EQ(found_.at(1), nullptr);
  EXPECT_EQ(cache.stats().residentBytes, kBytes);
  EXPECT_EQ(cache.stats().residentNodes, 1u);
}

TEST_F(NodeCacheTest, ZeroCapacityRefusesEverything) {
  NodeCache cache(0, kParents);
  EXPECT_EQ(add(cache, 0), Insertion::refused);
  EXPECT_EQ(out_.size(), 1u) << "the caller gets the node back";
  EXPECT_EQ(cache.stats().refusals, 1u);
  EXPECT_EQ(cache.stats().residentBytes, 0u);
}

TEST_F(NodeCacheTest, ANodeLargerThanTheCacheEvictsNothing) {
  NodeCache cache(2 * kBytes, kParents);
  add(cache, 0);
  EXPECT_EQ(cache.insert(1, makeNode(3 * kPoints), out_), Insertion::refused);
  EXPECT_TRUE(cache.contains(0));
  EXPECT_EQ(cache.stats().evictions, 0u);
}

TEST_F(NodeCacheTest, TheLeastRecentlyWantedGoesFirst) {
  NodeCache cache(3 * kBytes, kParents);
  add(cache, 3);
  add(cache, 4);
  add(cache, 5);
  unpin(cache, pin(cache, {3}));
  add(cache, 6);
  EXPECT_TRUE(cache.contains(3));
  EXPECT_FALSE(cache.contains(4));
  EXPECT_EQ(cache.stats().evictions, 1u);
}

TEST_F(NodeCacheTest, EntriesInUseAreNotEvicted) {
  NodeCache cache(2 * kBytes, kParents);
  add(cache, 3);
  add(cache, 4);
  const auto pins = pin(cache, {3, 4});
  EXPECT_EQ(add(cache, 5), Insertion::refused);
  EXPECT_TRUE(cache.contains(3));
  EXPECT_TRUE(cache.contains(4));
  unpin(cache, pins);
  EXPECT_EQ(add(cache, 5), Insertion::inserted);
}

TEST_F(NodeCacheTest, AnEntryPinnedTwiceStaysUntilTheSecondUnpin) {
  NodeCache cache(kBytes, kParents);
  add(cache, 3);
  const auto first = pin(cache, {3});
  const auto second = pin(cache, {3});
  unpin(cache, first);
  EXPECT_EQ(add(cache, 5), Insertion::refused);
  unpin(cache, second);
  EXPECT_EQ(add(cache, 5), Insertion::inserted);
}

TEST_F(NodeCacheTest, AParentOutlivesItsChildren) {
  NodeCache cache(3 * kBytes, kParents);
  add(cache, 0);
  add(cache, 1);
  add(cache, 3);
  add(cache, 5);
  EXPECT_FALSE(cache.contains(3)) << "the only one without children";
  add(cache, 6);
  EXPECT_FALSE(cache.contains(1)) << "its turn now that its child has gone";
  EXPECT_TRUE(cache.contains(0) || !cache.contains(2));
}

TEST_F(NodeCacheTest, AParentIsNotEvictedToMakeRoomForItsChild) {
  NodeCache cache(kBytes, kParents);
  add(cache, 1);
  EXPECT_EQ(add(cache, 3), Insertion::refused);
  EXPECT_TRUE(cache.contains(1));
}

TEST_F(NodeCacheTest, AncestorsOfAPinnedNodeAreHeldWithIt) {
  NodeCache cache(3 * kBytes, kParents);
  add(cache, 0);
  add(cache, 1);
  add(cache, 3);
  const auto pins = pin(cache, {3});
  EXPECT_EQ(cache.stats().pinnedBytes, 3 * kBytes);
  EXPECT_EQ(add(cache, 5), Insertion::refused);
  unpin(cache, pins);
  EXPECT_EQ(cache.stats().pinnedBytes, 0u);
}

TEST_F(NodeCacheTest, AParentThatComesAfterItsPinnedChildIsHeldToo) {
  NodeCache cache(2 * kBytes, kParents);
  add(cache, 3);
  const auto pins = pin(cache, {3});
  add(cache, 1);
  EXPECT_EQ(cache.stats().pinnedBytes, 2 * kBytes);
  EXPECT_EQ(add(cache, 5), Insertion::refused);
  unpin(cache, pins);
  EXPECT_EQ(cache.stats().pinnedBytes, 0u);
}

TEST_F(NodeCacheTest, AParentOlderThanItsChildIsEvictedInTheSameGo) {
  NodeCache cache(3 * kBytes, kParents);
  add(cache, 1);
  add(cache, 3);
  add(cache, 5);
  // Needs the room of two: 1 is the oldest, but has to wait for 3.
  EXPECT_EQ(cache.insert(6, makeNode(2 * kPoints), out_), Insertion::inserted);
  EXPECT_TRUE(cache.contains(5));
  EXPECT_FALSE(cache.contains(1));
  EXPECT_FALSE(cache.contains(3));
}

TEST_F(NodeCacheTest, ARicherVersionReplacesAPoorerOne) {
  NodeCache cache(10 * kBytes, kParents);
  add(cache, 0, 1);
  EXPECT_EQ(add(cache, 0, 2), Insertion::replaced);
  EXPECT_EQ(add(cache, 0, 2), Insertion::duplicate);
  EXPECT_EQ(add(cache, 0, 1), Insertion::duplicate);
  EXPECT_EQ(cache.stats().residentBytes, makeNode(kPoints, 2)->memoryBytes());
  EXPECT_EQ(cache.stats().residentNodes, 1u);
  EXPECT_EQ(cache.stats().duplicates, 2u);
}

TEST_F(NodeCacheTest, AReplacedVersionThatIsDrawnIsCountedUntilItIsLetGo) {
  NodeCache cache(10 * kBytes, kParents);
  add(cache, 0, 1);
  const auto pins = pin(cache, {0});
  add(cache, 0, 2);
  EXPECT_EQ(cache.stats().residentBytes, kBytes + makeNode(kPoints, 2)->memoryBytes());
  unpin(cache, pins);
  EXPECT_EQ(cache.stats().residentBytes, makeNode(kPoints, 2)->memoryBytes());
  EXPECT_EQ(cache.stats().pinnedBytes, 0u);
}

TEST_F(NodeCacheTest, AReplacementThatDoesNotFitLeavesTheOldVersion) {
  NodeCache cache(kBytes, kParents);
  add(cache, 0, 1);
  EXPECT_EQ(add(cache, 0, 3), Insertion::refused);
  EXPECT_TRUE(cache.contains(0));
  EXPECT_EQ(cache.stats().residentBytes, kBytes);
}

/// A slow cache that is plainly right. The real one must agree with it at every step.
class Model {
 public:
  Model(std::uint64_t capacity, std::vector<std::uint32_t> parents)
      : capacity_(capacity), parents_(std::move(parents)) {}

  struct Entry {
    const StreamedNode* data;
    std::uint64_t bytes;
    int planes;
    std::uint64_t order;
    int pins = 0;
  };

  bool evictable(std::uint32_t node, std::uint32_t keep) const {
    if (entries.at(node).pins > 0 || node == keep) return false;
    for (const auto& [other, entry] : entries)
      if (parents_[other] == node) return false;
    return true;
  }

  Insertion insert(std::uint32_t node, const StreamedNode* data, std::uint64_t bytes, int planes) {
    const auto present = entries.find(node);
    if (present != entries.end() && planes <= present->second.planes) return Insertion::duplicate;
    Model trial = *this;
    const bool frees = present != entries.end() && present->second.pins == 0;
    const std::uint64_t leaving = frees ? present->second.bytes : 0;
    while (trial.bytes() - leaving + bytes > capacity_)
      if (!trial.evictOldest(present != entries.end() ? node : parents_[node])) return Insertion::refused;
    *this = trial;
    const auto old = entries.find(node);
    if (old == entries.end()) {
      entries[node] = {data, bytes, planes, ++clock};
      return Insertion::inserted;
    }
    if (old->second.pins > 0) retired[old->second.data] = {old->second.bytes, old->second.pins};
    old->second = {data, bytes, planes, old->second.order};
    return Insertion::replaced;
  }

  bool evictOldest(std::uint32_t keep) {
    std::uint32_t oldest = kNone;
    for (const auto& [node, entry] : entries)
      if (evictable(node, keep) && (oldest == kNone || entry.order < entries[oldest].order)) oldest = node;
    if (oldest == kNone) return false;
    entries.erase(oldest);
    return true;
  }

  std::uint64_t bytes() const {
    std::uint64_t total = 0;
    for (const auto& [node, entry] : entries) total += entry.bytes;
    for (const auto& [data, entry] : retired) total += entry.first;
    return total;
  }

  std::map<std::uint32_t, Entry> entries;
  std::map<const StreamedNode*, std::pair<std::uint64_t, int>> retired;
  std::uint64_t clock = 0;

 private:
  std::uint64_t capacity_;
  std::vector<std::uint32_t> parents_;
};

TEST(NodeCacheModel, AgreesWithAPlainlyRightCacheOverRandomOperations) {
  std::vector<std::uint32_t> parents{kNone};
  for (std::uint32_t i = 1; i < 85; ++i) parents.push_back((i - 1) / 4);
  for (int round = 0; round < 30; ++round) {
    std::mt19937 engine(static_cast<unsigned>(round));
    const auto random = [&engine] { return static_cast<std::uint32_t>(engine()); };
    const std::uint64_t capacity = (2 + random() % 20) * kBytes;
    NodeCache cache(capacity, parents);
    Model model(capacity, parents);
    std::vector<std::vector<NodeCache::Pin>> lists;
    std::vector<NodeCache::Released> out;
    std::vector<NodeCache::Data> found;
    for (int step = 0; step < 600; ++step) {
      const std::uint32_t what = random() % 10;
      if (what < 6) {
        const std::uint32_t node = random() % 85;
        const int planes = 1 + static_cast<int>(random() % 3);
        const auto data = makeNode(kPoints / 2 + random() % kPoints, planes);
        ASSERT_EQ(cache.insert(node, data, out), model.insert(node, data.get(), data->memoryBytes(), planes));
      } else if (what < 8 && lists.size() < 3) {
        std::set<std::uint32_t> nodes;
        for (int i = 0; i < 6; ++i)
          for (std::uint32_t node = random() % 85; node != kNone; node = parents[node]) nodes.insert(node);
        lists.emplace_back();
        cache.pin(std::vector<std::uint32_t>(nodes.begin(), nodes.end()), found, lists.back());
        std::size_t pinned = 0;
        for (auto node = nodes.rbegin(); node != nodes.rend(); ++node) {
          const auto entry = model.entries.find(*node);
          if (entry == model.entries.end()) continue;
          ++entry->second.pins;
          entry->second.order = ++model.clock;
          ++pinned;
        }
        ASSERT_EQ(lists.back().size(), pinned);
      } else if (!lists.empty()) {
        const std::size_t at = random() % lists.size();
        for (const NodeCache::Pin& pin : lists[at]) {
          const auto entry = model.entries.find(pin.node);
          if (entry != model.entries.end() && entry->second.data == pin.data)
            --entry->second.pins;
          else if (--model.retired.at(pin.data).second == 0)
            model.retired.erase(pin.data);
        }
        found.clear();
        cache.unpin(lists[at], out);
        lists.erase(lists.begin() + static_cast<std::ptrdiff_t>(at));
      }
      out.clear();

      const NodeCacheStats stats = cache.stats();
      ASSERT_EQ(stats.residentBytes, model.bytes()) << "round " << round << " step " << step << " what " << what;
      ASSERT_LE(stats.peakBytes, capacity);
      ASSERT_EQ(stats.residentNodes, model.entries.size());
      for (std::uint32_t node = 0; node < 85; ++node)
        ASSERT_EQ(cache.contains(node), model.entries.contains(node)) << "round " << round << " step " << step;
      std::set<std::uint32_t> held;
      for (const auto& [node, entry] : model.entries)
        if (entry.pins > 0)
          for (std::uint32_t at = node; at != kNone && model.entries.contains(at); at = parents[at]) held.insert(at);
      std::uint64_t heldBytes = 0;
      for (const std::uint32_t node : held) heldBytes += model.entries.at(node).bytes;
      ASSERT_EQ(stats.pinnedBytes, heldBytes);
    }
  }
}

}  // namespace
}  // namespace strata
