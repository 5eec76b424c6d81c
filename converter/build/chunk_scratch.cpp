#include "converter/build/chunk_scratch.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "converter/memory/copy_bytes.h"
#include "converter/memory/vector4.h"

namespace strata {
namespace {

constexpr int kLevels = 3;  // of the cells that records are sorted by

/// Three bits, two zero bits before each.
constexpr std::uint16_t kSpread[8] = {0, 1, 8, 9, 64, 65, 72, 73};

using CellStarts = std::array<std::size_t, (1u << (3 * kLevels)) + 1>;

/// Finds the cell of each point three levels down, and where the cells begin.
template <typename Coordinate>
void findCells(const CellCoordinates& cell, std::size_t stride, std::span<const std::byte> points, std::uint16_t* cells,
               CellStarts& starts) {
  for (std::size_t i = 0; i * stride < points.size(); ++i) {
    Coordinate grid[3];
    std::memcpy(grid, points.data() + i * stride, sizeof grid);
    unsigned code = 0;
    for (const Coordinate g : grid)
      code = code << 1 |
             kSpread[static_cast<std::uint32_t>(cell.local(static_cast<std::int64_t>(g))) >> (cell.bits - kLevels)];
    cells[i] = static_cast<std::uint16_t>(code);
    ++starts[code + 1];
  }
  for (std::size_t c = 1; c < starts.size(); ++c) starts[c] += starts[c - 1];
}

template <typename Coordinate>
void arrangeAs(const CellCoordinates& cell, std::size_t stride, std::span<const std::byte> points,
               ChunkScratch& scratch) {
  const std::size_t count = points.size() / stride;
  CellStarts starts{};
  std::uint16_t* cells = scratch.tree.ranks.room(count).data();
  const bool sorted = cell.bits >= kLevels;
  if (sorted) findCells<Coordinate>(cell, stride, points, cells, starts);
  Columns& columns = scratch.columns[0];
  for (std::size_t i = 0; i < count; ++i) {
    const std::byte* from = points.data() + i * stride;
    const std::size_t to = sorted ? starts[cells[i]]++ : i;
    Coordinate grid[3];
    std::memcpy(grid, from, sizeof grid);
    for (std::size_t axis = 0; axis < 3; ++axis)
      columns.axis[axis][to] = cell.local(static_cast<std::int64_t>(grid[axis]));
    columns.record[to] = static_cast<std::uint32_t>(to);
    copyBytes(scratch.records.data() + to * stride, from, stride);
  }
}

void findOctants(const Columns& columns, std::size_t begin, std::size_t end, int bit, std::uint8_t* octants) {
  const std::int32_t *x = columns.axis[0].data(), *y = columns.axis[1].data(), *z = columns.axis[2].data();
  std::size_t i = begin;
  for (; i + 4 <= end; i += 4) {
    const Int4 octant =
        (loadInts(x + i) >> bit & 1) << 2 | (loadInts(y + i) >> bit & 1) << 1 | (loadInts(z + i) >> bit & 1);
    for (std::size_t lane = 0; lane < 4; ++lane) octants[i + lane] = static_cast<std::uint8_t>(octant[lane]);
  }
  for (; i < end; ++i)
    octants[i] = static_cast<std::uint8_t>((x[i] >> bit & 1) << 2 | (y[i] >> bit & 1) << 1 | (z[i] >> bit & 1));
}

}  // namespace

void Columns::room(std::size_t count) {
  for (auto& a : axis) a.room(count);
  record.room(count);
}

void arrange(const BuildContext& context, const CellCoordinates& cell, std::span<const std::byte> points,
             ChunkScratch& scratch) {
  const std::size_t count = points.size() / context.format.stride();
  scratch.records.room(points.size());
  for (Columns& columns : scratch.columns) columns.room(count);
  if (context.format.wide)
    arrangeAs<std::int64_t>(cell, context.format.stride(), points, scratch);
  else
    arrangeAs<std::uint32_t>(cell, context.format.stride(), points, scratch);
}

std::array<std::size_t, 9> divide(ChunkScratch& scratch, int side, PointRange range, int bit,
                                  std::span<const std::uint32_t> kept) {
  const auto [begin, end] = range;
  const Columns& from = scratch.columns[side];
  Columns& to = scratch.columns[1 - side];
  std::uint8_t* octant = scratch.octants.data();
  findOctants(from, begin, end, bit, octant);
  for (const std::uint32_t i : kept) octant[begin + i] = 8;
  std::array<std::size_t, 9> counts{};
  for (std::size_t i = begin; i < end; ++i) ++counts[octant[i]];
  std::array<std::size_t, 9> starts;
  starts[0] = begin;
  for (std::size_t o = 0; o < 8; ++o) starts[o + 1] = starts[o] + counts[o];
  // Kept points go behind the others, where nobody looks: that is cheaper than a branch.
  std::array<std::size_t, 9> next = starts;
  for (std::size_t i = begin; i < end; ++i) {
    const std::size_t at = next[octant[i]]++;
    for (std::size_t axis = 0; axis < 3; ++axis) to.axis[axis][at] = from.axis[axis][i];
    to.record[at] = from.record[i];
  }
  return starts;
}

std::unique_ptr<ChunkScratch> ScratchPool::lend() {
  {
    const MutexLock lock(mutex_);
    if (!free_.empty()) {
      std::unique_ptr<ChunkScratch> scratch = std::move(free_.back());
      free_.pop_back();
      return scratch;
    }
  }
  return std::make_unique<ChunkScratch>();
}

void ScratchPool::giveBack(std::unique_ptr<ChunkScratch> scratch) {
  const MutexLock lock(mutex_);
  if (free_.size() < kMostKept) free_.push_back(std::move(scratch));
}

}  // namespace strata
