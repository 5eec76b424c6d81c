#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/point_layout.h"
#include "io/scan/point_source.h"

namespace strata {

/// A point record as it stands in a LAS file.
struct LasRecordFormat {
  int pointFormat = 0;             ///< 0 to 10
  std::uint16_t recordBytes = 20;  ///< with extra bytes

  bool extended() const { return pointFormat >= 6; }
  bool operator==(const LasRecordFormat&) const = default;
};

/// The columns of `format`, extra bytes as `vlrs` describe them. They are ordered so that all but six bytes of a
/// packed record stand as in the file: behind intensity, return number, number of returns, classification and flags
/// come the file's bytes from scan angle rank (formats 0 to 5) or user data (6 to 10) to the end.
PointLayout lasLayout(const LasRecordFormat& format, const std::vector<LasMeta::Vlr>& vlrs);

/// Bytes of a packed record of lasLayout(format, ...).
std::size_t lasStride(const LasRecordFormat& format);

/// Splits `positions.size()` raw records into positions (integer * scale, so relative to the header's offset) and
/// packed attributes. Loses no bit of any format.
void unpackLasRecords(const LasRecordFormat& format, const glm::dvec3& scale, const std::byte* records,
                      std::span<glm::dvec3> positions, std::byte* attributes);
/// The same with the file's integers as they are.
void unpackLasRecords(const LasRecordFormat& format, const std::byte* records, std::span<glm::ivec3> integers,
                      std::byte* attributes);

/// The inverse, from the file's integers; writes integers.size() records.
void packLasRecords(const LasRecordFormat& format, std::span<const glm::ivec3> integers, const std::byte* attributes,
                    std::byte* records);

}  // namespace strata
