#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "converter/build/build_context.h"
#include "converter/build/ntree.h"
#include "converter/memory/buffer.h"
#include "core/mutex.h"
#include "io/store/node_codec.h"

namespace strata {

/// The part of a chunk's points that moves on the way down the tree: positions, and where the records lie.
struct Columns {
  Buffer<std::int32_t> axis[3];  ///< local integers, as LocalPoints has them
  Buffer<std::uint32_t> record;  ///< index into ChunkScratch::records

  void room(std::size_t count);
};

/// The memory for building a chunk, worth keeping from chunk to chunk.
struct ChunkScratch {
  Buffer<std::byte> records;     ///< packed, in the order of the cells three levels down
  Columns columns[2];            ///< used in turn by level
  Buffer<std::uint8_t> octants;  ///< of the points that are being divided; 8 = the point stays in the node
  TreeScratch tree;
  NodePoints node;
  EncodeScratch encode;
};

/// Fills `records`, and `columns[0]` along with them, from packed points in any order.
void arrange(const BuildContext& context, const CellCoordinates& cell, std::span<const std::byte> points,
             ChunkScratch& scratch);

/// Consecutive points of Columns.
struct PointRange {
  std::size_t begin = 0, end = 0;

  std::size_t count() const { return end - begin; }
};

/// Moves the points of a range of columns[side] that are not in `kept` (indices into the range) to the same range of
/// columns[1 - side], sorted by octant and otherwise in their order. `bit` of a coordinate tells octants apart. Returns
/// where each octant begins, and at index 8 where the last one ends.
std::array<std::size_t, 9> divide(ChunkScratch& scratch, int side, PointRange range, int bit,
                                  std::span<const std::uint32_t> kept);

/// Lends any number of scratches at the same time and keeps a few for the next to ask. Thread-safe.
class ScratchPool {
 public:
  static constexpr std::size_t kMostKept = 4;
  std::unique_ptr<ChunkScratch> lend() STRATA_EXCLUDES(mutex_);
  void giveBack(std::unique_ptr<ChunkScratch> scratch) STRATA_EXCLUDES(mutex_);

 private:
  Mutex mutex_;
  std::vector<std::unique_ptr<ChunkScratch>> free_ STRATA_GUARDED_BY(mutex_);
};

}  // namespace strata
