#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/box.h"
#include "io/scan/point_source.h"
#include "io/table/field.h"
#include "io/table/record_mapping.h"

namespace strata {

/// The ranges of the fields and the digits of the coordinates over some of a file's records.
struct RecordSample {
  static constexpr int kManyDecimals = 10;

  std::vector<FieldRange> ranges;  ///< one for each field
  Box bounds;                      ///< of the points whose coordinates are all finite
  std::uint64_t points = 0;
  int decimals = 0;  ///< with which every coordinate can be written; kManyDecimals when more than 9 are needed
};

/// Adds little-endian records of `recordBytes` bytes to the sample, whose `ranges` has one entry for each field.
void addToSample(RecordSample& sample, const std::vector<Field>& fields, std::span<const std::byte> records,
                 std::size_t recordBytes);

/// Sets the bounds, the step and the grid of `info`. `complete` says that the sample holds every point of the file.
void describePositions(const RecordMapping& mapping, const RecordSample& sample, bool complete, SourceInfo& info);

}  // namespace strata
