#pragma once
#include <algorithm>
#include <cstdint>
#include <functional>
#include <list>
#include <optional>
#include <vector>

namespace strata {

/// A range of a pool, taken or free.
struct PoolBlock {
  std::uint32_t first = 0;
  std::uint32_t size = 0;
  bool free = true;
  std::uint32_t owner = 0;       ///< the caller's, of a taken one
  std::uint32_t importance = 0;  ///< frames it was shown less frames it was not
  std::uint64_t shown = 0;       ///< the last frame it was shown in
};

/// Hands out ranges of a pool: first fit over a doubly linked list of all blocks, which are split when taken and merged
/// with free neighbours when given back (Rumpler 2019, 3.4). Where there is no room, blocks that the view does not show
/// are freed, the least important first (3.4.2). A block that was shown in this frame is never freed, which his counter
/// does not promise; of equals the one not shown for longest goes.
class PoolManager {
 public:
  using Block = std::list<PoolBlock>::iterator;
  static constexpr std::uint32_t kMostImportance = 1000;  ///< frames; what was shown for hours must not stay for hours

  explicit PoolManager(std::uint32_t size);

  /// Every block loses importance. Those that this frame shows are to be shown() before allocate() is called.
  void beginFrame();
  void shown(Block block);
  /// What allocate() gives and frees lies below this, so that a view that needs little of the pool finds its blocks
  /// close together; at first, and at most, all of the pool. To be set before the frame's first allocate().
  void setLimit(std::uint32_t limit) { limit_ = std::min(limit, size_); }
  std::uint32_t limit() const { return limit_; }
  /// Takes `size`, at least 1, for `owner`; counts as shown. `freed` is told the owner of each block that has to go,
  /// before it goes.
  /// None where the blocks that are shown leave too little room, or, when all others are gone, too little in one piece.
  std::optional<Block> allocate(std::uint32_t size, std::uint32_t owner,
                                const std::function<void(std::uint32_t owner)>& freed);
  void release(Block block);

  std::uint32_t size() const { return size_; }
  std::uint32_t freePoints() const { return free_; }
  /// By ascending first; they cover the pool without gaps, and no two free ones touch.
  const std::list<PoolBlock>& blocks() const { return blocks_; }

 private:
  Block firstFit(std::uint32_t size);
  void findVictims();

  std::uint32_t size_ = 0, free_ = 0, limit_ = 0;
  std::uint64_t frame_ = 1;
  std::list<PoolBlock> blocks_;
  Block lowestFree_;            ///< no free block lies before it
  std::vector<Block> victims_;  ///< below the limit, not shown in this frame, the first to go last; found when needed
  bool victimsKnown_ = false;
};

}  // namespace strata
