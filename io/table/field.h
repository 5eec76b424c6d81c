#pragma once
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>

#include "core/scalar.h"

namespace strata {

static_assert(std::endian::native == std::endian::little, "records are read as they lie in little-endian files");

/// One named value of the record that a PLY, PCD or text file has for each point.
struct Field {
  std::string name;
  ScalarType type = ScalarType::f32;
  std::uint32_t count = 1;  ///< numbers under this name
  std::size_t offset = 0;   ///< bytes from the start of the record

  std::size_t bytes() const { return scalarBytes(type) * count; }
};

/// The range of a field's first number over the points that were looked at before reading.
struct FieldRange {
  double min = std::numeric_limits<double>::infinity();
  double max = -std::numeric_limits<double>::infinity();

  bool empty() const { return !(min <= max); }
  /// Ignores NaN and infinity.
  void add(double value);
  void add(const FieldRange& other);
};

/// Indices of the fields x, y and z, in either case; -1 where one is missing.
struct AxisFields {
  int index[3] = {-1, -1, -1};
};
AxisFields findAxes(std::span<const Field> fields);

}  // namespace strata
