#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "io/file/byte_source.h"
#include "io/scan/point_source.h"
#include "io/table/field_map.h"

namespace strata {

/// Points that lie in a file one after the other, all records of the same size.
struct RecordFile {
  std::string format;            ///< for SourceInfo
  std::uint64_t dataOffset = 0;  ///< bytes before the first record
  std::uint64_t pointCount = 0;
  std::size_t recordBytes = 0;
  bool bigEndian = false;
  bool skipDamaged = false;  ///< a file that ends early gives the whole records it has
  std::vector<Field> fields;
};

/// A source that reads such records in parts of about a million points; never holds more than a block. Its
/// constructor looks at all points of files of up to a million (whose bounds are then exact), else at 64 runs of a
/// thousand, to learn ranges and the step. Throws Error where the file is too short for its count.
std::unique_ptr<PointSource> openRecords(std::unique_ptr<ByteSource> bytes, RecordFile file);

/// Ranges of fields and coordinates over some of the points.
struct RecordSample {
  std::vector<FieldRange> ranges;  ///< one a field
  Box bounds;                      ///< of the points whose coordinates are all finite
  std::uint64_t points = 0;
  int decimals = 0;  ///< that all coordinates get by with; kManyDecimals where more than 9
  static constexpr int kManyDecimals = 10;
};
/// `records` are little-endian; adds them to the sample.
void addToSample(RecordSample& sample, const std::vector<Field>& fields, std::span<const std::byte> records,
                 std::size_t recordBytes);

/// Fills in what a sample tells of the source: bounds, step and whether the step is a grid that all points lie on.
/// `complete` = the sample has every point.
void describePositions(const FieldMap& map, const RecordSample& sample, bool complete, SourceInfo& info);

/// Reverses the bytes of every value of every record.
void swapBytes(std::span<std::byte> records, std::size_t recordBytes, const std::vector<Field>& fields);

/// Appends `count` records to the block.
void appendRecords(const FieldMap& map, const std::byte* records, std::size_t recordBytes, std::size_t count,
                   PointBlock& block);

}  // namespace strata
