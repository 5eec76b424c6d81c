#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "converter/distribute/packed_points.h"
#include "converter/journal/journal.h"
#include "converter/journal/record_bytes.h"
#include "converter/journal/spill.h"
#include "core/node_key.h"

namespace strata {

/// The cells some levels below a node, addressed by their Morton index inside it.
struct CellGrid {
  static constexpr int kMostLevels = 5;  // an index fits 16 bits

  NodeKey parent;
  int levels = 0;  ///< below the parent, at most kMostLevels
  int shift = 0;   ///< of a grid integer to get the cell at that level

  CellGrid(NodeKey parentCell, int levelsBelow, int cubeBits)
      : parent(parentCell), levels(levelsBelow), shift(cubeBits - parentCell.level() - levelsBelow) {}

  std::size_t cells() const { return std::size_t{1} << (3 * levels); }
  NodeKey cell(std::size_t index) const { return {parent.code << (3 * levels) | index}; }
  /// Grid integers of the cell's lowest corner.
  std::array<std::uint64_t, 3> corner(std::size_t index) const;
};

/// How the points of a run are cut down in the temporary file: coordinates count from their cell's corner, in as many
/// whole bytes as the cell needs; bytes of the attribute record that are the same in all points are left out.
struct RunShape {
  struct Span {
    std::uint16_t from = 0, bytes = 0;
  };
  std::uint32_t axisBytes = 0;
  std::vector<std::byte> constants;  ///< an attribute record that has the left-out bytes
  std::vector<Span> kept;            ///< of the attribute record, ascending

  std::size_t stride() const;
};

/// One cell's share of a run, as it stands in the journal.
struct RunCell {
  std::uint32_t cell;
  std::uint32_t points;
  std::uint32_t checksum;  ///< low half of the XXH3-64 of the stored points
};

/// Points in the temporary file, sorted by cell: the points of neighbouring cells are neighbours.
struct Run {
  std::uint64_t sequence = 0;  ///< place of its points in the order of the input
  std::uint64_t offset = 0;    ///< in the temporary file
  std::uint64_t cellsAt = 0;   ///< of its RunCells in the journal
  std::uint32_t cells = 0;     ///< that have points
  std::uint32_t points = 0;
  RunShape shape;
};

/// A run that has been written, before the journal knows of it.
struct WrittenRun {
  Run run;
  std::vector<RunCell> cells;  ///< ascending
};

/// All points of one node, or of all of the cube, by cell.
struct RunSet {
  CellGrid grid;
  std::vector<Run> runs;              ///< by sequence, once complete
  std::vector<std::uint64_t> points;  ///< by cell

  explicit RunSet(const CellGrid& cellGrid) : grid(cellGrid), points(cellGrid.cells()) {}
};

/// What a record of kind `runs` begins with.
struct RunsHead {
  std::uint64_t set = 0;   ///< by number; 0 is that of all points
  std::uint64_t task = 0;  ///< whose points they are, by number in the set
};
/// Appends such a record: the head, what the caller has to say (`extra`), and the runs. Fills in where the cells of
/// each run stand.
void appendRuns(Journal& journal, const RunsHead& head, const RecordWriter& extra, std::vector<WrittenRun>& written);

/// The same, read back.
struct RunsRecord {
  RunsHead head;
  std::vector<std::byte> extra;
  std::vector<WrittenRun> written;
};
RunsRecord readRuns(const Journal& journal, const Journal::Place& place);

/// Part of a run: the points of neighbouring cells.
struct Extent {
  const Run* run = nullptr;
  std::uint64_t offset = 0;  ///< in the temporary file
  std::uint64_t points = 0;
  std::vector<RunCell> cells;
};

/// Walks through the runs of a set cell by cell; the lists of cells stay in the journal but for a few at a time.
/// Used by one thread.
class RunCursor {
 public:
  RunCursor(const RunSet& set, const Journal& journal);
  /// The extents of cells first <= cell < end, by sequence. Ranges have to be asked for in ascending order.
  std::vector<Extent> take(std::size_t firstCell, std::size_t endCell);

 private:
  struct Place {
    std::uint32_t nextCell = 0;    ///< index into the run's cells of the first that is not buffered
    std::uint32_t pointsDone = 0;  ///< of the cells that were passed
    std::vector<RunCell> buffer;   ///< what comes next, last first
  };
  bool peek(std::size_t run, RunCell& cell);

  const RunSet& set_;
  const Journal& journal_;
  std::vector<Place> places_;
};

/// Reads the points of an extent, some at a time; throws Error where they are not as they were written.
class ExtentReader {
 public:
  /// All must outlive it.
  ExtentReader(const Spill& spill, const CellGrid& grid, const PackedFormat& format, const Extent& extent);
  ~ExtentReader();
  ExtentReader(const ExtentReader&) = delete;
  ExtentReader& operator=(const ExtentReader&) = delete;

  std::uint64_t left() const { return left_; }
  /// Unpacks the next `count` points, at most left(). `scratch` is storage to be used again.
  void read(std::size_t count, std::vector<std::byte>& scratch, std::byte* out);

 private:
  struct Checksum;
  void check(std::span<const std::byte> stored, bool cellBegins, bool cellEnds);

  const Spill& spill_;
  const CellGrid& grid_;
  const PackedFormat format_;
  const Extent& extent_;
  std::size_t cell_ = 0;        ///< index into the extent's cells
  std::uint64_t cellDone_ = 0;  ///< points of it that have been read
  std::uint64_t offset_, left_;
  std::unique_ptr<Checksum> checksum_;  ///< of a cell that is read in pieces
};

/// Low half of the XXH3-64.
std::uint32_t shortChecksum(std::span<const std::byte> bytes);

}  // namespace strata
