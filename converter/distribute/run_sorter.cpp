#include "converter/distribute/run_sorter.h"

#include <algorithm>
#include <cstring>

#include "converter/memory/copy_bytes.h"
#include "converter/memory/fixed_size.h"
#include "core/morton.h"

namespace strata {
namespace {

constexpr std::size_t kSlack = 16;  // bytes that a store may touch behind a record

}  // namespace

std::uint64_t RunSorter::memoryBytes(const PackedFormat& format, std::size_t points) {
  return points * (2 * format.stride() + sizeof(std::uint16_t)) + (std::uint64_t{1} << 19);
}

RunSorter::RunSorter(const PackedFormat& format, std::size_t runPoints, Spill& spill)
    : format_(format),
      runPoints_(std::max(runPoints, kBlockPoints)),
      spill_(spill),
      differs_(format.attributeBytes, 0),
      cells_(runPoints_) {
  stored_.room(runPoints_ * format.stride() + kSlack);
  sorted_.room(runPoints_ * format.stride() + kSlack);
}

void RunSorter::aim(const CellGrid& grid, std::uint64_t firstSequence) {
  grid_ = grid;
  sequence_ = firstSequence;
  counts_.assign(grid.cells(), 0);
  spread_.resize(std::size_t{1} << grid.levels);
  for (std::size_t i = 0; i < spread_.size(); ++i) spread_[i] = static_cast<std::uint16_t>(spreadBits(i));
}

/// Decides which attribute bytes the run stores, and begins a new run where a block needs more of them.
void RunSorter::shapeFor(const std::byte* attributes, const AttributeVariation& variation) {
  const std::size_t bytes = format_.attributeBytes;
  bool more = false;
  for (std::size_t b = 0; b < bytes; ++b) {
    const bool other = count_ > 0 && attributes[b] != shape_.constants[b];
    more = more || ((variation.differs[b] != 0 || other) && differs_[b] == 0);
  }
  if (count_ > 0 && !more) return;
  if (more) {
    for (std::size_t b = 0; b < bytes; ++b)
      if (variation.differs[b] != 0 || (count_ > 0 && attributes[b] != shape_.constants[b])) differs_[b] = 1;
    flush();
  }
  shape_.axisBytes = static_cast<std::uint32_t>((grid_->shift + 7) / 8);
  shape_.constants.assign(attributes, attributes + bytes);
  shape_.kept.clear();
  for (std::size_t b = 0; b < bytes; ++b) {
    if (differs_[b] == 0) continue;
    if (!shape_.kept.empty() && shape_.kept.back().from + shape_.kept.back().bytes == static_cast<int>(b))
      ++shape_.kept.back().bytes;
    else
      shape_.kept.push_back({static_cast<std::uint16_t>(b), 1});
  }
  stride_ = shape_.stride();
}

template <typename Grid>
void RunSorter::cutDown(const std::byte* points, std::size_t count) {
  const int shift = grid_->shift;
  const Grid inside = shift >= static_cast<int>(8 * sizeof(Grid)) ? ~Grid{0} : (Grid{1} << shift) - 1;
  const Grid cellMask = (Grid{1} << grid_->levels) - 1;
  const std::size_t axisBytes = shape_.axisBytes;
  const std::size_t stride = format_.stride();
  const std::uint16_t* spread = spread_.data();
  std::byte* to = stored_.data() + count_ * stride_;
  std::uint16_t* cells = cells_.data() + count_;
  const auto cellOf = [&](Grid v) {
    return spread[shift >= static_cast<int>(8 * sizeof(Grid)) ? 0 : (v >> shift) & cellMask];
  };
  for (std::size_t i = 0; i < count; ++i) {
    const std::byte* record = points + i * stride;
    Grid grid[3];
    std::memcpy(grid, record, sizeof grid);
    const auto cell = static_cast<std::uint16_t>(cellOf(grid[0]) << 2 | cellOf(grid[1]) << 1 | cellOf(grid[2]));
    cells[i] = cell;
    ++counts_[cell];
    for (const Grid v : grid) {
      const Grid kept = v & inside;
      std::memcpy(to, &kept, sizeof kept);  // the rest is overwritten by what follows
      to += axisBytes;
    }
    const std::byte* attributes = record + sizeof grid;
    for (const RunShape::Span& span : shape_.kept) {
      copyBytes(to, attributes + span.from, span.bytes);
      to += span.bytes;
    }
  }
  count_ += count;
}

void RunSorter::add(const std::byte* points, std::size_t count, const AttributeVariation& variation) {
  if (count == 0) return;
  if (count_ + count > runPoints_) flush();
  shapeFor(points + format_.positionBytes(), variation);
  if (format_.wide)
    cutDown<std::uint64_t>(points, count);
  else
    cutDown<std::uint32_t>(points, count);
}

/// Counting sort, which keeps the order inside a cell.
void RunSorter::sortByCell(const std::vector<std::uint32_t>& starts) {
  std::vector<std::uint32_t> next(starts);
  withFixedSize<40>(stride_, [&](auto stride) {
    const std::byte* from = stored_.data();
    std::byte* to = sorted_.data();
    for (std::size_t i = 0; i < count_; ++i)
      std::memcpy(to + std::size_t{next[cells_[i]]++} * stride, from + i * stride, stride);
  });
}

void RunSorter::flush() {
  if (count_ == 0) return;
  WrittenRun out;
  std::vector<std::uint32_t> starts(counts_.size() + 1);
  for (std::size_t c = 0; c < counts_.size(); ++c) starts[c + 1] = starts[c] + counts_[c];
  sortByCell(starts);
  for (std::size_t c = 0; c < counts_.size(); ++c)
    if (counts_[c] > 0)
      out.cells.push_back({static_cast<std::uint32_t>(c), counts_[c],
                           shortChecksum({sorted_.data() + starts[c] * stride_, counts_[c] * stride_})});
  out.run.sequence = sequence_++;
  out.run.points = static_cast<std::uint32_t>(count_);
  out.run.shape = shape_;
  out.run.offset = spill_.append({sorted_.data(), count_ * stride_});
  written_.push_back(std::move(out));
  std::fill(counts_.begin(), counts_.end(), 0u);
  count_ = 0;
}

std::vector<WrittenRun> RunSorter::finish() {
  flush();
  return std::move(written_);
}

}  // namespace strata
