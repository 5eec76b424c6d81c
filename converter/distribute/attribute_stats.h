#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "converter/distribute/attribute_variation.h"
#include "converter/journal/record_bytes.h"
#include "core/point_layout.h"
#include "io/store/store.h"

namespace strata {

/// Smallest and largest value of every attribute, and the percentiles of intensity. Not thread-safe: one a thread,
/// then add() them up.
class AttributeStats {
 public:
  explicit AttributeStats(const PointLayout& layout);
  /// `records`: `count` attribute records, `stride` bytes apart; `variation` is theirs.
  void gather(const std::byte* records, std::size_t stride, std::size_t count, const AttributeVariation& variation);
  void add(const AttributeStats& other);
  void clear();
  std::vector<AttributeRange> ranges() const;

  void write(RecordWriter& record) const;
  /// Adds what write() wrote for the same layout.
  void addFrom(RecordReader& record);

 private:
  PointLayout layout_;
  std::vector<AttributeRange> ranges_;
  std::vector<std::uint64_t> intensities_;  ///< histogram of all 65536 values; empty without intensity
  std::uint64_t points_ = 0;
};

}  // namespace strata
