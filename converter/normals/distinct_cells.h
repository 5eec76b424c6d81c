#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace strata {

/// How many cells of each size have points in them, to about 2 %, in memory that does not grow: one HyperLogLog
/// (Flajolet et al. 2007) a size. The same for any order of the points. Not thread-safe: one a thread, then add() them
/// up.
class DistinctCells {
 public:
  /// Cells of 2^0 to 2^(sizes - 1) grid steps.
  explicit DistinctCells(int sizes);
  void see(const std::int64_t (&grid)[3]);
  void add(const DistinctCells& other);
  /// Number of occupied cells of 2^shift steps.
  double count(int shift) const;
  int sizes() const { return static_cast<int>(registers_.size()); }

 private:
  static constexpr int kIndexBits = 11;
  std::vector<std::array<std::uint8_t, std::size_t{1} << kIndexBits>> registers_;  ///< by shift
};

}  // namespace strata
