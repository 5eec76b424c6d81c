#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace strata {

/// How the points of a run are shortened in the spill: coordinates count from the corner of their cell, in as many
/// whole bytes as the cell needs, and bytes of the attribute record that are the same in all points are left out.
struct RunShape {
  struct Span {
    std::uint16_t from = 0, bytes = 0;
  };
  std::uint32_t axisBytes = 0;
  std::vector<std::byte> constants;  ///< an attribute record that has the left-out bytes
  std::vector<Span> kept;            ///< parts of the attribute record that are stored, ascending

  /// Bytes of a stored point.
  std::size_t stride() const {
    std::size_t bytes = 3 * std::size_t{axisBytes};
    for (const Span& span : kept) bytes += span.bytes;
    return bytes;
  }
};

/// The points of a run that lie in one cell; the journal record of the run holds one RunCell for each cell that has
/// points.
struct RunCell {
  std::uint32_t cell;  ///< index in the CellGrid of the run set
  std::uint32_t points;
  std::uint32_t checksum;  ///< low half of the XXH3-64 of the stored points
};

/// About a million points in the spill, sorted by cell.
struct Run {
  std::uint64_t sequence = 0;  ///< runs in this order have their points in the order of the input
  std::uint64_t offset = 0;    ///< in the spill
  std::uint64_t cellsAt = 0;   ///< offset of its RunCells in the journal
  std::uint32_t cells = 0;     ///< number of its RunCells
  std::uint32_t points = 0;
  RunShape shape;
};

/// A run that is in the spill, and its cells.
struct WrittenRun {
  Run run;
  std::vector<RunCell> cells;  ///< ascending
};

}  // namespace strata
