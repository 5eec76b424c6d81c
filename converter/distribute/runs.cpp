#include "converter/distribute/runs.h"

#include <xxhash.h>

#include <algorithm>

#include "converter/memory/fixed_size.h"
#include "core/error.h"
#include "io/file/checksum.h"

namespace strata {
namespace {

constexpr std::size_t kCursorCells = 64;  // of a run in memory at a time

constexpr std::size_t kSlack = 8;  // bytes behind a stored record that are read with it

/// Turns the stored points of one cell into packed ones. Reads up to kSlack bytes too many.
template <typename Stride>
void unpackCell(const RunShape& shape, const PackedFormat& format, const std::array<std::uint64_t, 3>& corner,
                const std::byte* stored, std::size_t count, Stride attributeBytes, std::byte* out) {
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
    if (format.wide) {
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
      copyFew(out + span.from, stored, span.bytes);
      stored += span.bytes;
    }
    out += attributeBytes;
  }
}

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

std::size_t RunShape::stride() const {
  std::size_t bytes = 3 * std::size_t{axisBytes};
  for (const Span& span : kept) bytes += span.bytes;
  return bytes;
}

void appendRuns(Journal& journal, const RunsHead& head, const RecordWriter& extra, std::vector<WrittenRun>& written) {
  RecordWriter record;
  record.put(head);
  record.putAll(extra.bytes());
  record.put<std::uint64_t>(written.size());
  std::vector<std::size_t> cellsAt;
  for (const WrittenRun& w : written) {
    record.put(w.run.sequence);
    record.put(w.run.offset);
    record.put(w.run.points);
    record.put(w.run.shape.axisBytes);
    record.putAll(std::span(w.run.shape.constants));
    record.putAll(std::span(w.run.shape.kept));
    cellsAt.push_back(record.size() + sizeof(std::uint64_t));
    record.putAll(std::span(w.cells));
  }
  const std::uint64_t start = journal.append(RecordKind::runs, record.bytes());
  for (std::size_t i = 0; i < written.size(); ++i) {
    written[i].run.cellsAt = start + cellsAt[i];
    written[i].run.cells = static_cast<std::uint32_t>(written[i].cells.size());
  }
}

RunsRecord readRuns(const Journal& journal, const Journal::Place& place) {
  const std::vector<std::byte> payload = journal.payload(place);
  RecordReader record(payload);
  RunsRecord out;
  out.head = record.get<RunsHead>();
  out.extra = record.getAll<std::byte>();
  out.written.resize(record.get<std::uint64_t>());
  for (WrittenRun& w : out.written) {
    w.run.sequence = record.get<std::uint64_t>();
    w.run.offset = record.get<std::uint64_t>();
    w.run.points = record.get<std::uint32_t>();
    w.run.shape.axisBytes = record.get<std::uint32_t>();
    w.run.shape.constants = record.getAll<std::byte>();
    w.run.shape.kept = record.getAll<RunShape::Span>();
    w.run.cellsAt = place.offset + record.position() + sizeof(std::uint64_t);
    w.cells = record.getAll<RunCell>();
    w.run.cells = static_cast<std::uint32_t>(w.cells.size());
  }
  return out;
}

RunCursor::RunCursor(const RunSet& set, const Journal& journal)
    : set_(set), journal_(journal), places_(set.runs.size()) {}

bool RunCursor::peek(std::size_t r, RunCell& cell) {
  Place& place = places_[r];
  const Run& run = set_.runs[r];
  if (place.buffer.empty()) {
    const std::size_t count = std::min<std::size_t>(kCursorCells, run.cells - place.nextCell);
    if (count == 0) return false;
    place.buffer.resize(count);
    journal_.read(run.cellsAt + place.nextCell * sizeof(RunCell), std::as_writable_bytes(std::span(place.buffer)));
    std::reverse(place.buffer.begin(), place.buffer.end());
    place.nextCell += static_cast<std::uint32_t>(count);
  }
  cell = place.buffer.back();
  return true;
}

std::vector<Extent> RunCursor::take(std::size_t firstCell, std::size_t endCell) {
  std::vector<Extent> extents;
  for (std::size_t r = 0; r < places_.size(); ++r) {
    const Run& run = set_.runs[r];
    Extent extent;
    extent.run = &run;
    for (RunCell cell; peek(r, cell) && cell.cell < endCell;) {
      if (cell.cell >= firstCell) {
        if (extent.cells.empty()) extent.offset = run.offset + places_[r].pointsDone * run.shape.stride();
        extent.points += cell.points;
        extent.cells.push_back(cell);
      }
      places_[r].pointsDone += cell.points;
      places_[r].buffer.pop_back();
    }
    if (extent.points > 0) extents.push_back(std::move(extent));
  }
  return extents;
}

struct ExtentReader::Checksum {
  std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state{XXH3_createState(), &XXH3_freeState};
};

ExtentReader::ExtentReader(const Spill& spill, const CellGrid& grid, const PackedFormat& format, const Extent& extent)
    : spill_(spill), grid_(grid), format_(format), extent_(extent), offset_(extent.offset), left_(extent.points) {}

ExtentReader::~ExtentReader() = default;

void ExtentReader::check(std::span<const std::byte> stored, bool cellBegins, bool cellEnds) {
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
  if (found != extent_.cells[cell_].checksum)
    throw Error(spill_.path(), "temporary points are damaged; --force starts the conversion again");
}

void ExtentReader::read(std::size_t count, std::vector<std::byte>& scratch, std::byte* out) {
  const RunShape& shape = extent_.run->shape;
  const std::size_t stride = shape.stride();
  if (scratch.size() < count * stride + kSlack) scratch.resize(count * stride + kSlack);
  spill_.read(offset_, std::span(scratch).first(count * stride));
  offset_ += count * stride;
  left_ -= count;
  for (const std::byte* stored = scratch.data(); count > 0;) {
    const RunCell& cell = extent_.cells[cell_];
    const std::size_t points = std::min<std::size_t>(count, cell.points - cellDone_);
    const bool ends = cellDone_ + points == cell.points;
    check({stored, points * stride}, cellDone_ == 0, ends);
    withFixedSize<40>(format_.attributeBytes, [&](auto attributeBytes) {
      unpackCell(shape, format_, grid_.corner(cell.cell), stored, points, attributeBytes, out);
    });
    stored += points * stride;
    out += points * format_.stride();
    count -= points;
    cellDone_ = ends ? 0 : cellDone_ + points;
    if (ends) ++cell_;
  }
}

}  // namespace strata
