#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/point_layout.h"
#include "io/scan/point_source.h"

namespace strata {

/// The point records of a LAS file.
struct LasRecordFormat {
  int pointFormat = 0;             ///< 0 to 10
  std::uint16_t recordBytes = 20;  ///< with extra bytes

  bool extended() const { return pointFormat >= 6; }
  bool operator==(const LasRecordFormat&) const = default;
};

/// The attributes of a format, with its extra bytes as `vlrs` describe them. An attribute record in this order, which
/// is called a packed record below, begins with the six bytes of intensity, return number, number of returns,
/// classification and flags. The rest is copied from the file as it is, from scan angle rank (formats 0 to 5) or user
/// data (6 to 10) to the end.
PointLayout lasLayout(const LasRecordFormat& format, const std::vector<LasMeta::Vlr>& vlrs);

/// Bytes of a packed record.
std::size_t lasStride(const LasRecordFormat& format);

/// Splits positions.size() records of a file into positions, which are integer * scale and so relative to the header's
/// offset, and packed records. No bit of any format is lost.
void unpackLasRecords(const LasRecordFormat& format, const glm::dvec3& scale, const std::byte* records,
                      std::span<glm::dvec3> positions, std::byte* attributes);
/// Does the same, but gives the file's integers as they are.
void unpackLasRecords(const LasRecordFormat& format, const std::byte* records, std::span<glm::ivec3> integers,
                      std::byte* attributes);

/// The inverse of the second: writes integers.size() records of a file.
void packLasRecords(const LasRecordFormat& format, std::span<const glm::ivec3> integers, const std::byte* attributes,
                    std::byte* records);

}  // namespace strata
