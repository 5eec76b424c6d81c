#pragma once
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/box.h"
#include "core/point_layout.h"

namespace strata {

static_assert(std::endian::native == std::endian::little, "records are read as they lie in little-endian files");

/// One named value of a point's record as a PLY, PCD or text file has it.
struct Field {
  std::string name;
  ScalarType type = ScalarType::f32;
  std::uint32_t count = 1;  ///< values that stand under this name
  std::size_t offset = 0;   ///< bytes from the start of the record

  std::size_t bytes() const { return scalarBytes(type) * count; }
};

/// What is known of a field's first value from the points looked at before reading.
struct FieldRange {
  double min = std::numeric_limits<double>::infinity();
  double max = -std::numeric_limits<double>::infinity();

  bool empty() const { return !(min <= max); }
  /// Leaves values that are not finite out.
  void add(double value);
  void add(const FieldRange& other);
};

/// The value of a scalar in little-endian memory, as a double.
inline double loadScalar(const std::byte* bytes, ScalarType type) {
  const auto load = [bytes]<typename T>(T value) {
    std::memcpy(&value, bytes, sizeof value);
    return static_cast<double>(value);
  };
  switch (type) {
    case ScalarType::u8:
      return load(std::uint8_t{});
    case ScalarType::i8:
      return load(std::int8_t{});
    case ScalarType::u16:
      return load(std::uint16_t{});
    case ScalarType::i16:
      return load(std::int16_t{});
    case ScalarType::u32:
      return load(std::uint32_t{});
    case ScalarType::i32:
      return load(std::int32_t{});
    case ScalarType::u64:
      return load(std::uint64_t{});
    case ScalarType::i64:
      return load(std::int64_t{});
    case ScalarType::f32:
      return load(float{});
    case ScalarType::f64:
      return load(double{});
  }
  return 0.0;
}

/// Turns records of named fields into positions and packed attributes. The rules, by name without regard to case,
/// underscores and a leading `scalar_`:
///  - x, y, z are the position, in double.
///  - red green blue (or r g b): rgb u16. Integers as they are (clamped to 0..65535); floats times 255 where the range
///    says 0..1, else as they are, rounded.
///  - rgb, rgba of 4 bytes (PCD): bytes B, G, R, A; rgba also gives `extra:alpha`.
///  - nx ny nz or normal_x normal_y normal_z of float32: normal.
///  - intensity u8, u16: intensity. Any other type is kept exactly as `extra:intensity`, and intensity (u16, for
///    drawing) is made of it by intensityScale().
///  - classification u8: classification. Any other type is kept as `extra:NAME`, classification is its clamped value.
///  - a field that has the name and type of another known attribute (gps_time f64, ...) is that attribute.
///  - everything else is `extra:NAME` with its type and count; fields named `_` are padding.
class FieldMap {
 public:
  FieldMap() = default;
  /// `ranges` has one entry a field. Throws Error naming `file` where x, y or z is missing.
  FieldMap(const std::string& file, std::span<const Field> fields, std::span<const FieldRange> ranges);

  const PointLayout& layout() const { return layout_; }
  const Field& axis(int index) const { return axes_[index]; }
  glm::dvec3 position(const std::byte* record) const {
    return {loadScalar(record + axes_[0].offset, axes_[0].type), loadScalar(record + axes_[1].offset, axes_[1].type),
            loadScalar(record + axes_[2].offset, axes_[2].type)};
  }
  /// Fills layout().stride() bytes.
  void attributes(const std::byte* record, std::byte* out) const;

 private:
  /// One piece of an attribute: bytes copied, or a number rounded to scale * value + offset.
  struct Step {
    std::size_t from = 0;
    std::size_t to = 0;
    std::size_t copyBytes = 0;  ///< 0 = convert
    ScalarType fromType = ScalarType::u8;
    ScalarType toType = ScalarType::u8;  ///< u8 or u16
    double scale = 1.0;
    double offset = 0.0;
  };
  friend class FieldMapBuilder;

  Field axes_[3];
  PointLayout layout_;
  std::vector<Step> steps_;
};

/// drawn = (value + shift) * scale, clamped to 0..65535: 0..1 fills the 16 bits, 0..255 is times 257, 0..65535 stays,
/// -2048..2047 (PTS) is (value + 2048) * 16, anything else is stretched from its range.
struct IntensityScale {
  double shift = 0.0;
  double scale = 1.0;
};
IntensityScale intensityScale(const FieldRange& range);

/// The type that a field of this name needs to become an attribute that Strata knows; of rgb and normals too.
std::optional<ScalarType> knownFieldType(std::string_view name);

/// The three fields that hold the position, by index, -1 where one is missing.
struct AxisFields {
  int index[3] = {-1, -1, -1};
};
AxisFields findAxes(std::span<const Field> fields);

/// A power of ten that is at most half a unit in the last place of float32 at `largest`; 0 for 0.
double float32Step(double largest);
/// For doubles whose last digit says nothing: a power of ten that is at most 1e-9 of the longest side of the points'
/// box (of the largest coordinate where that is 0), and no finer than 1e-9. 0 where all is 0.
double float64Step(const Box& bounds);

/// Gives axes that have no step (all coordinates 0) the coarsest of the others, 0.001 where none has one.
glm::dvec3 fillSteps(glm::dvec3 step);

}  // namespace strata
