#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "converter/distribute/attribute_variation.h"
#include "converter/distribute/runs.h"
#include "converter/memory/page_buffer.h"

namespace strata {

/// Collects packed points, sorts them by cell and writes them as runs. Used by one thread; its storage is used again
/// for every run.
class RunSorter {
 public:
  /// Memory it takes for runs of at most `points` points.
  static std::uint64_t memoryBytes(const PackedFormat& format, std::size_t points);

  RunSorter(const PackedFormat& format, std::size_t runPoints, Spill& spill);

  /// Points that follow are of this set; those of another have to be flushed before.
  void aim(const CellGrid& grid, std::uint64_t firstSequence);
  /// At most kBlockPoints packed points that lie in the set's node. `variation` is that of their attributes.
  void add(const std::byte* points, std::size_t count, const AttributeVariation& variation);
  static constexpr std::size_t kBlockPoints = 8192;
  /// Writes what has been collected and returns all runs since the last call.
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
  std::vector<std::uint8_t> differs_;  ///< bytes that are kept; grows over the runs
  RunShape shape_;
  std::size_t stride_ = 0;
  std::size_t count_ = 0;
  PageBuffer stored_, sorted_;
  std::vector<std::uint16_t> cells_;   ///< of each point
  std::vector<std::uint32_t> counts_;  ///< of each cell
  std::vector<WrittenRun> written_;
};

}  // namespace strata
