#pragma once
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/file/byte_source.h"
#include "io/scan/point_source.h"
#include "io/table/field.h"

namespace strata {

/// A file whose points are records of one size, one after the other.
struct RecordFile {
  std::string format;            ///< for SourceInfo
  std::uint64_t dataOffset = 0;  ///< bytes before the first record
  std::uint64_t pointCount = 0;
  std::size_t recordBytes = 0;
  bool bigEndian = false;
  bool skipDamaged = false;  ///< a file that ends early gives the whole records it has
  std::vector<Field> fields;
  std::optional<glm::dvec3> viewpoint;  ///< for SourceInfo
};

/// Opens such a file as parts of about a million points; a reader holds one block of it at a time. The constructor
/// learns the ranges of the fields and the step of the grid from a sample: all points of a file with at most a million,
/// else 64 runs of a thousand points. The bounds are exact when all points were read. Throws Error when the file is too
/// short for its point count.
std::unique_ptr<PointSource> openRecords(std::unique_ptr<ByteSource> bytes, RecordFile file);

}  // namespace strata
