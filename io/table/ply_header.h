#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/point_layout.h"

namespace strata {

/// One property of an element. A list has a `countType`, which is the type of the count before its items.
struct PlyProperty {
  std::string name;
  ScalarType type = ScalarType::f32;
  std::optional<ScalarType> countType;
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  bool hasLists() const;
  /// Bytes of one item of the element in a binary file, when it has no lists.
  std::size_t bytes() const;
};

enum class PlyEncoding : std::uint8_t { ascii, littleEndian, bigEndian };

/// The header of a PLY file (Turk 1994). Types may have the names given there or int8 to float64; `bool` is a byte.
struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::ascii;
  std::vector<PlyElement> elements;
  std::size_t vertex = 0;       ///< index of the element whose items are the points
  std::size_t headerBytes = 0;  ///< including the end of the line end_header
  std::uint64_t headerLines = 0;
};

/// Decodes the header at the start of `head`. Throws Error naming `file` and the line.
PlyHeader parsePlyHeader(const std::string& file, std::string_view head);

}  // namespace strata
