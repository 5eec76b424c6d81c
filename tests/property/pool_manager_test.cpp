// The memory manager of the point pool, compared with a model that looks at every place.
#include "render/progressive/pool_manager.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

namespace strata {
namespace {

constexpr std::uint32_t kNobody = 0xffffffffu;

/// A pool as an array of owners.
struct Model {
  struct Held {
    std::uint32_t first, size, importance;
    std::uint64_t shown;
  };
  std::vector<std::uint32_t> ownerOf;
  std::map<std::uint32_t, Held> held;
  std::uint64_t frame = 1;
  std::uint32_t limit;

  explicit Model(std::uint32_t size) : ownerOf(size, kNobody), limit(size) {}

  void beginFrame() {
    ++frame;
    for (auto& [owner, block] : held) block.importance -= block.importance > 0;
  }
  void shown(std::uint32_t owner) {
    Held& block = held.at(owner);
    if (block.shown == frame) return;
    block.shown = frame;
    block.importance = std::min(block.importance + 2, PoolManager::kMostImportance);
  }
  std::uint32_t firstFit(std::uint32_t size) const {
    std::uint32_t run = 0;
    for (std::uint32_t i = 0; i < limit; ++i) {
      run = ownerOf[i] == kNobody ? run + 1 : 0;
      if (run == size) return i + 1 - size;
    }
    return kNobody;
  }
  void release(std::uint32_t owner) {
    std::replace(ownerOf.begin(), ownerOf.end(), owner, kNobody);
    held.erase(owner);
  }
  std::uint32_t leastImportant() const {
    std::uint32_t found = kNobody;
    for (const auto& [owner, b] : held) {
      if (b.shown == frame || b.first >= limit) continue;
      const auto rank = [](const Held& h) { return std::make_tuple(h.importance, h.shown, h.first); };
      if (found == kNobody || rank(b) < rank(held.at(found))) found = owner;
    }
    return found;
  }
  bool allocate(std::uint32_t size, std::uint32_t owner, std::vector<std::uint32_t>& freed) {
    std::uint32_t at = firstFit(size);
    if (at == kNobody) {
      const auto open = [this](std::uint32_t o) { return o == kNobody || held.at(o).shown != frame; };
      const auto room = std::count_if(ownerOf.begin(), ownerOf.begin() + limit, open);
      if (static_cast<std::uint32_t>(room) < size) return false;
    }
    for (; at == kNobody; at = firstFit(size)) {
      const std::uint32_t victim = leastImportant();
      if (victim == kNobody) return false;
      freed.push_back(victim);
      release(victim);
    }
    std::fill_n(ownerOf.begin() + at, size, owner);
    held[owner] = {at, size, 1, frame};
    return true;
  }
};

void expectSame(const PoolManager& manager, const Model& model) {
  std::uint32_t at = 0, free = 0;
  bool before = false;
  for (const PoolBlock& block : manager.blocks()) {
    ASSERT_EQ(block.first, at);
    ASSERT_GT(block.size, 0u);
    ASSERT_FALSE(before && block.free) << "free blocks touch at " << at;
    before = block.free;
    for (std::uint32_t i = at; i < at + block.size; ++i)
      ASSERT_EQ(model.ownerOf[i], block.free ? kNobody : block.owner) << "place " << i;
    if (!block.free) {
      ASSERT_EQ(block.importance, model.held.at(block.owner).importance);
    }
    free += block.free ? block.size : 0;
    at += block.size;
  }
  ASSERT_EQ(at, manager.size());
  ASSERT_EQ(free, manager.freePoints());
}

class PoolManagerRuns : public testing::TestWithParam<std::uint32_t> {};

TEST_P(PoolManagerRuns, DoesWhatTheModelDoesUnderRandomUse) {
  std::mt19937 random(GetParam());
  const auto below = [&](std::uint32_t n) { return static_cast<std::uint32_t>(random()) % n; };
  const std::uint32_t size = 200 + below(3000), largest = 1 + below(size / 4);
  PoolManager manager(size);
  Model model(size);
  std::map<std::uint32_t, PoolManager::Block> held;
  std::uint32_t nextOwner = 0, refused = 0, evicted = 0;
  for (int frame = 0; frame < 150; ++frame) {
    manager.beginFrame();
    model.beginFrame();
    std::vector<std::uint32_t> shownNow;
    for (const auto& [owner, block] : held)
      if (below(3) == 0) shownNow.push_back(owner);
    for (const std::uint32_t owner : shownNow) {
      manager.shown(held.at(owner));
      model.shown(owner);
    }
    model.limit = below(3) == 0 ? size / 2 + below(size) : size;
    manager.setLimit(model.limit);
    model.limit = std::min(model.limit, size);
    for (int step = 0; step < 12; ++step) {
      if (!held.empty() && below(4) == 0) {
        const auto victim = std::next(held.begin(), below(static_cast<std::uint32_t>(held.size())));
        model.release(victim->first);
        std::erase(shownNow, victim->first);
        manager.release(victim->second);
        held.erase(victim);
      } else {
        const std::uint32_t wanted = 1 + below(largest), owner = nextOwner++;
        std::vector<std::uint32_t> freed, expected;
        const auto block = manager.allocate(wanted, owner, [&](std::uint32_t gone) {
          freed.push_back(gone);
          held.erase(gone);
        });
        ASSERT_EQ(model.allocate(wanted, owner, expected), block.has_value());
        ASSERT_EQ(freed, expected);
        evicted += static_cast<std::uint32_t>(freed.size());
        refused += !block;
        if (block) {
          ASSERT_EQ((*block)->first, model.held.at(owner).first);
          held[owner] = *block;
        }
      }
      expectSame(manager, model);
      if (HasFatalFailure()) return;
    }
    for (const std::uint32_t owner : shownNow) ASSERT_TRUE(held.contains(owner)) << "a block that is shown was freed";
  }
  EXPECT_GT(evicted, 0u);
  for (const auto& [owner, block] : held) manager.release(block);
  EXPECT_EQ(manager.blocks().size(), 1u);
  EXPECT_EQ(manager.freePoints(), size);
}

INSTANTIATE_TEST_SUITE_P(Seeds, PoolManagerRuns, testing::Range(1u, 25u));

TEST(PoolManager, FreesWhatWasShownLeastAndNeverWhatIsShown) {
  PoolManager manager(100);
  std::vector<std::uint32_t> freed;
  const auto note = [&](std::uint32_t owner) { freed.push_back(owner); };
  const auto a = *manager.allocate(40, 0, note), b = *manager.allocate(40, 1, note);
  for (int frame = 0; frame < 5; ++frame) {
    manager.beginFrame();
    manager.shown(a);
    if (frame < 3) manager.shown(b);
  }
  EXPECT_FALSE(manager.allocate(61, 2, note)) << "40 of 100 are shown";
  EXPECT_TRUE(freed.empty());
  EXPECT_TRUE(manager.allocate(60, 2, note));
  EXPECT_EQ(freed, std::vector<std::uint32_t>{1});
  EXPECT_FALSE(manager.allocate(1, 3, note));
}

TEST(PoolManager, LeavesAloneWhatLiesBeyondTheLimit) {
  PoolManager manager(100);
  const auto nothingFreed = [](std::uint32_t owner) { ADD_FAILURE() << owner << " was freed"; };
  const auto low = *manager.allocate(40, 0, nothingFreed);
  manager.allocate(40, 1, nothingFreed);
  manager.beginFrame();
  manager.shown(low);
  manager.setLimit(50);
  EXPECT_FALSE(manager.allocate(11, 2, nothingFreed)) << "10 of the places of block 1 are below the limit";
  EXPECT_EQ(manager.freePoints(), 20u);
  manager.setLimit(1000);
  const auto high = manager.allocate(20, 3, nothingFreed);
  ASSERT_TRUE(high);
  EXPECT_EQ((*high)->first, 80u);
}

TEST(PoolManager, OfNothingGivesNothing) {
  EXPECT_FALSE(PoolManager(0).allocate(1, 0, [](std::uint32_t) {}));
}

}  // namespace
}  // namespace strata
