#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "converter/distribute/packed_points.h"
#include "converter/journal/journal.h"
#include "converter/journal/run.h"
#include "converter/journal/spill.h"
#include "core/node_key.h"

namespace strata {

/// The cells some levels below a node, addressed by their Morton index inside it.
struct CellGrid {
  static constexpr int kMostLevels = 5;  ///< an index fits 16 bits

  NodeKey parent;
  int levels = 0;  ///< below the parent, at most kMostLevels
  int shift = 0;   ///< a grid integer shifted right by it counts cells

  CellGrid(NodeKey parentCell, int levelsBelow, int cubeBits)
      : parent(parentCell), levels(levelsBelow), shift(cubeBits - parentCell.level() - levelsBelow) {}

  std::size_t cells() const { return std::size_t{1} << (3 * levels); }
  NodeKey cell(std::size_t index) const { return {parent.code << (3 * levels) | index}; }
  /// Grid integers of the cell's lowest corner.
  std::array<std::uint64_t, 3> corner(std::size_t index) const;
};

/// All runs that hold the points of one node, or of the whole cube, by smaller cells.
struct RunSet {
  CellGrid grid;
  std::vector<Run> runs;              ///< by sequence, once sortRuns() has sorted them
  std::vector<std::uint64_t> points;  ///< by cell

  explicit RunSet(const CellGrid& cellGrid) : grid(cellGrid), points(cellGrid.cells()) {}
  /// Adds runs in any order and returns how many points they have.
  std::uint64_t add(std::vector<WrittenRun>&& written);
  void sortRuns();
};

/// The points of neighbouring cells inside one run.
struct Stretch {
  const Run* run = nullptr;
  std::uint64_t offset = 0;  ///< in the spill
  std::uint64_t points = 0;
  std::vector<RunCell> cells;

  /// Behind its last byte in the spill.
  std::uint64_t end() const { return offset + points * run->shape.stride(); }
};

/// Walks through the runs of a set cell by cell. The lists of cells stay in the journal except for a few at a time.
/// Used by one thread.
class RunCursor {
 public:
  /// Both arguments must outlive the cursor, and the runs of the set must not change meanwhile.
  RunCursor(const RunSet& set, const Journal& journal);
  /// Returns the stretches of the cells first <= cell < end, by sequence. Ranges have to be asked for in ascending
  /// order.
  std::vector<Stretch> take(std::size_t firstCell, std::size_t endCell);

 private:
  /// How far the cursor has come in one run.
  struct RunPosition {
    std::uint32_t nextCell = 0;     ///< index into the run's cells of the first one that is not buffered
    std::uint32_t pointsDone = 0;   ///< points of the cells that were passed
    std::vector<RunCell> buffered;  ///< the cells that come next, last first
  };
  bool peek(std::size_t run, RunCell& cell);

  const RunSet& set_;
  const Journal& journal_;
  std::vector<RunPosition> positions_;  ///< by run of the set
};

/// Reads the points of a stretch, some at a time. Used by one thread.
class StretchReader {
 public:
  /// All arguments except `format` must outlive the reader.
  StretchReader(const Spill& spill, const CellGrid& grid, const PackedFormat& format, const Stretch& stretch);
  ~StretchReader();
  StretchReader(const StretchReader&) = delete;
  StretchReader& operator=(const StretchReader&) = delete;

  /// Points that are left to read.
  std::uint64_t left() const { return left_; }
  /// Unpacks the next `count` points, at most left(), to `out`; `scratch` is storage to be used again. Throws Error
  /// where the points are not as they were written.
  void read(std::size_t count, std::vector<std::byte>& scratch, std::byte* out);

 private:
  struct Checksum;
  void check(std::span<const std::byte> stored, bool cellBegins, bool cellEnds);
  template <typename Size>
  void unpack(const RunCell& cell, const std::byte* stored, std::size_t count, Size attributeBytes, std::byte* out);

  const Spill& spill_;
  const CellGrid& grid_;
  const PackedFormat format_;
  const Stretch& stretch_;
  std::size_t cell_ = 0;        ///< index into the stretch's cells
  std::uint64_t cellDone_ = 0;  ///< points of that cell that have been read
  std::uint64_t offset_, left_;
  std::unique_ptr<Checksum> checksum_;  ///< of a cell that is read in pieces
};

/// The low half of the XXH3-64 of the bytes.
std::uint32_t shortChecksum(std::span<const std::byte> bytes);

}  // namespace strata
