#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "converter/distribute/attribute_variation.h"
#include "converter/journal/point_counts.h"
#include "core/point_layout.h"
#include "io/store/store.h"

namespace strata {

/// Finds the smallest and largest value of every attribute, and the percentiles of intensity. Used by one thread; each
/// thread has its own, and add() joins their counts.
class AttributeStats {
 public:
  explicit AttributeStats(const PointLayout& layout);
  /// Counts `count` attribute records that lie `stride` bytes apart; `variation` is theirs.
  void gather(const std::byte* records, std::size_t stride, std::size_t count, const AttributeVariation& variation);
  /// Throws Error for counts of another layout.
  void add(const AttributeCounts& counts);
  void clear();
  const AttributeCounts& counts() const { return counts_; }
  /// Returns the range of every attribute in the form that a store keeps, in the order of the layout.
  std::vector<AttributeRange> ranges() const;

 private:
  PointLayout layout_;
  AttributeCounts counts_;
};

}  // namespace strata
