#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace strata {

/// Estimates how many cells of each size have points in them, to about 2 %, in memory that does not grow: one
/// HyperLogLog (Flajolet et al. 2007) per size. The result does not depend on the order of the points. Used by one
/// thread; each thread has its own, and add() joins them.
class DistinctCells {
 public:
  /// Counts cells with sides of 2^0 to 2^(sizes - 1) grid steps.
  explicit DistinctCells(int sizes);
  void see(const std::int64_t (&grid)[3]);
  void add(const DistinctCells& other);
  /// The number of occupied cells with sides of 2^shift grid steps.
  double count(int shift) const;

 private:
  static constexpr int kIndexBits = 11;
  std::vector<std::array<std::uint8_t, std::size_t{1} << kIndexBits>> registers_;  ///< by shift
};

}  // namespace strata
