#pragma once
#include <algorithm>
#include <cstdint>
#include <functional>
#include <list>
#include <optional>
#include <vector>

namespace strata {

/// A range of a pool, which is taken or free.
struct PoolBlock {
  std::uint32_t first = 0;
  std::uint32_t size = 0;
  bool free = true;
  std::uint32_t owner = 0;       ///< a number of the caller's, where it is taken
  std::uint32_t importance = 0;  ///< number of frames that showed it less those that did not
  std::uint64_t shown = 0;       ///< the last frame that showed it
};

/// Hands out ranges of a pool. All blocks form a doubly linked list, which is searched by first fit; blocks are split
/// when taken and merged with free neighbours when given back (Rumpler 2019, 3.4). Where room is missing, blocks that
/// the view does not show are freed, the least important first (3.4.2), and among equals the one not shown for longest.
/// Unlike his, this manager never frees a block that the current frame shows.
class PoolManager {
 public:
  using Block = std::list<PoolBlock>::iterator;
  /// Frames. The cap keeps a block that was shown for hours from staying for hours.
  static constexpr std::uint32_t kMostImportance = 1000;

  explicit PoolManager(std::uint32_t size);

  /// Lowers the importance of every block. Call shown() for the blocks that this frame shows before allocate().
  void beginFrame();
  void shown(Block block);
  /// Keeps what allocate() gives and frees below `limit`, so that a view that needs little of the pool finds its blocks
  /// close together. The limit is the size of the pool at first. Set it before the frame's first allocate().
  void setLimit(std::uint32_t limit) { limit_ = std::min(limit, size_); }
  std::uint32_t limit() const { return limit_; }
  /// Takes a block of `size`, at least 1, for `owner`; it counts as shown. Calls `freed` with the owner of each block
  /// that has to go, before it goes. Nothing where the blocks that this frame shows leave too little room, or too
  /// little in one piece after all others have gone.
  std::optional<Block> allocate(std::uint32_t size, std::uint32_t owner,
                                const std::function<void(std::uint32_t owner)>& freed);
  void release(Block block);

  std::uint32_t size() const { return size_; }
  std::uint32_t freePoints() const { return free_; }
  /// All blocks by ascending `first`. They cover the pool without gaps, and no two free ones touch.
  const std::list<PoolBlock>& blocks() const { return blocks_; }

 private:
  Block firstFit(std::uint32_t size);
  void findVictims();

  std::uint32_t size_ = 0, free_ = 0, limit_ = 0;
  std::uint64_t frame_ = 1;
  std::list<PoolBlock> blocks_;
  Block lowestFree_;            ///< no free block lies before it
  std::vector<Block> victims_;  ///< blocks below the limit that this frame does not show; the first to go is last
  bool victimsKnown_ = false;
};

}  // namespace strata
