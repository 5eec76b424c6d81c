#pragma once
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/table/field.h"

namespace strata {

enum class PcdEncoding : std::uint8_t { ascii, binary, binaryCompressed };

/// The header of a PCD file, versions .5 to .7 (pointclouds.org, "The PCD file format"). The offsets of the fields are
/// those in the records of a binary file.
struct PcdHeader {
  PcdEncoding encoding = PcdEncoding::ascii;
  std::vector<Field> fields;
  std::uint64_t points = 0;
  std::size_t recordBytes = 0;
  std::size_t headerBytes = 0;  ///< including the DATA line
  std::uint64_t headerLines = 0;
  /// World position of the sensor; nothing for 0 0 0, which writers put that do not know it.
  std::optional<glm::dvec3> viewpoint;
};

/// Decodes the header at the start of `head`. Throws Error naming `file` and the line.
PcdHeader parsePcdHeader(const std::string& file, std::string_view head);

}  // namespace strata
