#include "converter/distribute/runs.h"

#include <xxhash.h>

#include <algorithm>
#include <utility>

#include "converter/memory/copy_bytes.h"
#include "converter/memory/fixed_size.h"
#include "core/error.h"
#include "io/file/checksum.h"

namespace strata {
namespace {

constexpr std::size_t kCursorCells = 64;  // of a run in memory at a time
constexpr std::size_t kSlack = 8;         // bytes behind a stored point that are read with it

}  // namespace

std::uint32_t shortChecksum(std::span<const std::byte> bytes) { return static_cast<std::uint32_t>(checksum(bytes)); }

std::array<std::uint64_t, 3> CellGrid::corner(std::size_t index) const {
  const NodeKey key = cell(index);
  std::array<std::uint64_t, 3> out{};
  for (int level = key.level() - 1; level >= 0; --level) {
    const std::uint64_t octant = key.code >> (3 * level) & 7;
    for (std::size_t axis = 0; axis < 3; ++axis) out[axis] = out[axis] << 1 | (octant >> (2 - axis) & 1);
  }
  for (std::uint64_t& v : out) v <<= shift;
  return out;
}

std::uint64_t RunSet::add(std::vector<WrittenRun>&& written) {
  std::uint64_t added = 0;
  for (WrittenRun& one : written) {
    for (const RunCell& cell : one.cells) points.at(cell.cell) += cell.points;
    added += one.run.points;
    runs.push_back(std::move(one.run));
  }
  return added;
}

void RunSet::sortRuns() {
  std::sort(runs.begin(), runs.end(), [](const Run& a, const Run& b) { return a.sequence < b.sequence; });
}

RunCursor::RunCursor(const RunSet& set, const Journal& journal)
    : set_(set), journal_(journal), positions_(set.runs.size()) {}

bool RunCursor::peek(std::size_t r, RunCell& cell) {
  RunPosition& position = positions_[r];
  const Run& run = set_.runs[r];
  if (position.buffered.empty()) {
    const std::size_t count = std::min<std::size_t>(kCursorCells, run.cells - position.nextCell);
    if (count == 0) return false;
    position.buffered.resize(count);
    journal_.read(run.cellsAt + position.nextCell * sizeof(RunCell),
                  std::as_writable_bytes(std::span(position.buffered)));
    std::reverse(position.buffered.begin(), position.buffered.end());
    position.nextCell += static_cast<std::uint32_t>(count);
  }
  cell = position.buffered.back();
  return true;
}

std::vector<Stretch> RunCursor::take(std::size_t firstCell, std::size_t endCell) {
  std::vector<Stretch> stretches;
  for (std::size_t r = 0; r < positions_.size(); ++r) {
    const Run& run = set_.runs[r];
    RunPosition& position = positions_[r];
    Stretch stretch;
    stretch.run = &run;
    for (RunCell cell; peek(r, cell) && cell.cell < endCell;) {
      if (cell.cell >= firstCell) {
        if (stretch.cells.empty()) stretch.offset = run.offset + position.pointsDone * run.shape.stride();
        stretch.points += cell.points;
        stretch.cells.push_back(cell);
      }
      position.pointsDone += cell.points;
      position.buffered.pop_back();
    }
    if (stretch.points > 0) stretches.push_back(std::move(stretch));
  }
  return stretches;
}

struct StretchReader::Checksum {
  std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state{XXH3_createState(), &XXH3_freeState};
};

StretchReader::StretchReader(const Spill& spill, const CellGrid& grid, const PackedFormat& format,
                             const Stretch& stretch)
    : spill_(spill), grid_(grid), format_(format), stretch_(stretch), offset_(stretch.offset), left_(stretch.points) {}

StretchReader::~StretchReader() = default;

/// Turns the stored points of one cell into packed ones. Reads up to kSlack bytes too many.
template <typename Size>
void StretchReader::unpack(const RunCell& cell, const std::byte* stored, std::size_t count, Size attributeBytes,
                           std::byte* out) {
  const RunShape& shape = stretch_.run->shape;
  const bool wide = format_.wide;
  const std::array<std::uint64_t, 3> corner = grid_.corner(cell.cell);
  const std::size_t axisBytes = shape.axisBytes;
  const std::uint64_t axisMask = axisBytes >= 8 ? ~std::uint64_t{0} : (std::uint64_t{1} << (8 * axisBytes)) - 1;
  const std::byte* constants = shape.constants.data();
  for (std::size_t i = 0; i < count; ++i) {
    std::uint64_t grid[3];
    for (int axis = 0; axis < 3; ++axis) {
      std::memcpy(&grid[axis], stored, 8);
      grid[axis] = (grid[axis] & axisMask) + corner[static_cast<std::size_t>(axis)];
      stored += axisBytes;
    }
    if (wide) {
      std::memcpy(out, grid, 24);
      out += 24;
    } else {
      for (const std::uint64_t v : grid) {
        const auto narrow = static_cast<std::uint32_t>(v);
        std::memcpy(out, &narrow, 4);
        out += 4;
      }
    }
    if (attributeBytes > 0) std::memcpy(out, constants, attributeBytes);
    for (const RunShape::Span& span : shape.kept) {
      copyBytes(out + span.from, stored, span.bytes);
      stored += span.bytes;
    }
    out += attributeBytes;
  }
}

void StretchReader::check(std::span<const std::byte> stored, bool cellBegins, bool cellEnds) {
  std::uint32_t found;
  if (cellBegins && cellEnds) {
    found = shortChecksum(stored);
  } else {
    if (!checksum_) checksum_ = std::make_unique<Checksum>();
    if (cellBegins) XXH3_64bits_reset(checksum_->state.get());
    XXH3_64bits_update(checksum_->state.get(), stored.data(), stored.size());
    if (!cellEnds) return;
    found = static_cast<std::uint32_t>(XXH3_64bits_digest(checksum_->state.get()));
  }
  if (found != stretch_.cells[cell_].checksum)
    throw Error(spill_.path(), "temporary points are damaged; --force starts the conversion again");
}

void StretchReader::read(std::size_t count, std::vector<std::byte>& scratch, std::byte* out) {
  const RunShape& shape = stretch_.run->shape;
  const std::size_t stride = shape.stride();
  if (scratch.size() < count * stride + kSlack) scratch.resize(count * stride + kSlack);
  spill_.read(offset_, std::span(scratch).first(count * stride));
  offset_ += count * stride;
  left_ -= count;
  for (const std::byte* stored = scratch.data(); count > 0;) {
    const RunCell& cell = stretch_.cells[cell_];
    const std::size_t points = std::min<std::size_t>(count, cell.points - cellDone_);
    const bool ends = cellDone_ + points == cell.points;
    check({stored, points * stride}, cellDone_ == 0, ends);
    withFixedSize<40>(format_.attributeBytes,
                      [&](auto attributeBytes) { unpack(cell, stored, points, attributeBytes, out); });
    stored += points * stride;
    out += points * format_.stride();
    count -= points;
    cellDone_ = ends ? 0 : cellDone_ + points;
    if (ends) ++cell_;
  }
}

}  // namespace strata
