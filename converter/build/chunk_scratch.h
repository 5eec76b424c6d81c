#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "converter/build/node_builder.h"
#include "converter/build/ntree.h"
#include "converter/memory/buffer.h"

namespace strata {

/// Positions and where the records are, apart from these: what moves on the way down the tree.
struct Columns {
  Buffer<std::int32_t> axis[3];  ///< as LocalPoints has them
  Buffer<std::uint32_t> record;

  void room(std::size_t count);
};

/// What building a chunk holds for all of its points; worth keeping from chunk to chunk.
struct ChunkScratch {
  Buffer<std::byte> records;     ///< packed, in the order of the cells three levels down
  Columns columns[2];            ///< used in turn by level
  Buffer<std::uint8_t> octants;  ///< of the points that are being divided; 8: stays in the node
  TreeScratch tree;
  NodePoints node;
  EncodeScratch encode;
};

/// Fills `records`, and `columns[0]` along with them, from packed points in any order.
void arrange(const BuildFrame& frame, const CellFrame& cell, std::span<const std::byte> points, ChunkScratch& scratch);

/// Moves the points [begin, end) of `from` that are not in `kept` (places in that range) to `to`, sorted by octant
/// and otherwise in their order. `bit` of a coordinate tells octants apart. Returns where each octant begins, and at
/// index 8 where the last one ends.
std::array<std::size_t, 9> divide(const Columns& from, std::size_t begin, std::size_t end, int bit,
                                  std::span<const std::uint32_t> kept, Buffer<std::uint8_t>& octants, Columns& to);

/// Lends scratches, as many as are asked for at the same time, and keeps a few for the next. Thread-safe.
class ScratchPool {
 public:
  static constexpr std::size_t kMostKept = 4;
  std::unique_ptr<ChunkScratch> lend();
  void giveBack(std::unique_ptr<ChunkScratch> scratch);

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<ChunkScratch>> free_;  ///< guarded by mutex_
};

}  // namespace strata
