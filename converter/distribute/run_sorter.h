#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "converter/distribute/attribute_variation.h"
#include "converter/distribute/runs.h"
#include "converter/memory/buffer.h"

namespace strata {

/// Collects packed points, sorts them by cell and appends them to the spill as runs. Used by one thread; its storage is
/// used again for every run.
class RunSorter {
 public:
  /// The memory that a sorter takes for runs of at most `points` points.
  static std::uint64_t memoryBytes(const PackedFormat& format, std::size_t points);

  RunSorter(const PackedFormat& format, std::size_t runPoints, Spill& spill);

  /// Says which set the points that follow belong to. finish() comes before a change of the set.
  void aim(const CellGrid& grid, std::uint64_t firstSequence);
  /// Adds at most kBlockPoints packed points that lie in the set's node. `variation` is that of their attributes.
  void add(const std::byte* points, std::size_t count, const AttributeVariation& variation);
  static constexpr std::size_t kBlockPoints = 8192;
  /// Writes the points that have been collected and returns all runs since the last call. Throws Error.
  std::vector<WrittenRun> finish();

 private:
  void flush();
  void shapeFor(const std::byte* attributes, const AttributeVariation& variation);
  template <typename Grid>
  void cutDown(const std::byte* points, std::size_t count);
  void sortByCell(const std::vector<std::uint32_t>& starts);

  const PackedFormat format_;
  const std::size_t runPoints_;
  Spill& spill_;
  std::optional<CellGrid> grid_;
  std::vector<std::uint16_t> spread_;  ///< Morton bits of a cell's x, y or z
  std::uint64_t sequence_ = 0;         ///< of the next run
  std::vector<std::uint8_t> differs_;  ///< nonzero for the attribute bytes that are stored; grows over the runs
  RunShape shape_;
  std::size_t stride_ = 0;
  std::size_t count_ = 0;
  Buffer<std::byte> stored_, sorted_;  ///< points as they are in the spill, in the order of the input and by cell
  std::vector<std::uint16_t> cells_;   ///< the cell of each point
  std::vector<std::uint32_t> counts_;  ///< the points of each cell
  std::vector<WrittenRun> written_;
};

}  // namespace strata
