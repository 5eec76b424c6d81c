#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/point_layout.h"
#include "io/scan/point_source.h"
#include "io/table/field.h"

namespace strata {

/// The map from a file's records of named fields to positions and attribute records. Names are compared without regard
/// to case, underscores and a leading `scalar_`:
///  - x, y, z are the position, as doubles.
///  - red green blue (or r g b) become rgb. Integers stay as they are, clamped to 0..65535; floats are multiplied by
///  255
///    when all lie in 0..1, else rounded.
///  - rgb and rgba of 4 bytes (PCD) hold the bytes B, G, R, A; rgba also gives `extra:alpha`.
///  - nx ny nz (or normal_x normal_y normal_z) of float32 become normal.
///  - intensity of u8 or u16 becomes intensity. Any other type is kept exactly as `extra:intensity`, and the u16
///    intensity that is drawn comes from intensityScale().
///  - classification of u8 becomes classification. Any other type is kept exactly as `extra:NAME`, and classification
///  is
///    its value clamped to 0..255.
///  - A field with the name and type of another known attribute, such as gps_time of f64, becomes that attribute.
///  - Every other field becomes `extra:NAME` with its type and count, except for fields named `_`, which are padding.
class RecordMapping {
 public:
  RecordMapping() = default;
  /// `ranges` has one entry for each field. Throws Error naming `file` when x, y or z is missing.
  RecordMapping(const std::string& file, std::span<const Field> fields, std::span<const FieldRange> ranges);

  const PointLayout& layout() const { return layout_; }
  const Field& axis(int index) const { return axes_[index]; }
  /// Appends the points of `count` records, each of `recordBytes` bytes, to the block.
  void append(const std::byte* records, std::size_t recordBytes, std::size_t count, PointBlock& block) const;

 private:
  /// One piece of an attribute: bytes that are copied, or a number that is rounded to scale * value + offset.
  struct Step {
    std::size_t from = 0;
    std::size_t to = 0;
    std::size_t copyBytes = 0;  ///< 0 for a number
    ScalarType fromType = ScalarType::u8;
    ScalarType toType = ScalarType::u8;  ///< u8 or u16
    double scale = 1.0;
    double offset = 0.0;
  };
  friend class RecordMappingBuilder;

  glm::dvec3 position(const std::byte* record) const;
  /// Fills layout().stride() bytes.
  void attributes(const std::byte* record, std::byte* out) const;

  Field axes_[3];
  PointLayout layout_;
  std::vector<Step> steps_;
};

/// The type that a field of this name needs to become a known attribute, a colour or a normal; nothing for other names.
std::optional<ScalarType> knownFieldType(std::string_view name);

}  // namespace strata
