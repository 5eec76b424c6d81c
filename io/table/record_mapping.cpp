#include "io/table/record_mapping.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <utility>

#include "core/error.h"
#include "core/text.h"
#include "io/table/intensity_scale.h"

namespace strata {
namespace {

/// A name as it is compared: in lower case, without underscores and a leading `scalar_`.
std::string plainName(std::string_view name) {
  std::string plain = lowerCase(name);
  std::erase(plain, '_');
  if (plain.starts_with("scalar") && plain.size() > 6) plain.erase(0, 6);
  return plain;
}

struct Known {
  std::string_view name;
  ScalarType type;
};
/// Attributes that a field becomes when it has their name and type.
constexpr std::array<Known, 10> kKnown{{{attribute::kNir, ScalarType::u16},
                                        {attribute::kFlags, ScalarType::u8},
                                        {attribute::kReturnNumber, ScalarType::u8},
                                        {attribute::kNumberOfReturns, ScalarType::u8},
                                        {attribute::kScanAngleRank, ScalarType::i8},
                                        {attribute::kScanAngle, ScalarType::i16},
                                        {attribute::kUserData, ScalarType::u8},
                                        {attribute::kPointSourceId, ScalarType::u16},
                                        {attribute::kGpsTime, ScalarType::f64},
                                        {attribute::kClassification, ScalarType::u8}}};

bool isFloat(ScalarType type) { return type == ScalarType::f32 || type == ScalarType::f64; }

}  // namespace

std::optional<ScalarType> knownFieldType(std::string_view name) {
  const std::string plain = plainName(name);
  for (const Known& known : kKnown)
    if (plain == plainName(known.name)) return known.type;
  if (plain == attribute::kIntensity) return ScalarType::u16;
  for (const std::string_view colour : {"red", "green", "blue", "r", "g", "b"})
    if (plain == colour) return ScalarType::u16;
  for (const std::string_view normal : {"nx", "ny", "nz", "normalx", "normaly", "normalz"})
    if (plain == normal) return ScalarType::f32;
  return std::nullopt;
}

/// Collects attributes and steps. Where an attribute lies in the record is known only when all of them are.
class RecordMappingBuilder {
 public:
  RecordMappingBuilder(std::span<const Field> fields, std::span<const FieldRange> ranges, RecordMapping& mapping)
      : fields_(fields), ranges_(ranges), used_(fields.size(), false), mapping_(mapping) {}

  void build(const AxisFields& axes) {
    for (int axis = 0; axis < 3; ++axis) {
      const auto index = static_cast<std::size_t>(axes.index[axis]);
      mapping_.axes_[axis] = fields_[index];
      used_[index] = true;
    }
    addColour();
    addPackedColour();
    addIntensity();
    addNormal();
    for (std::size_t i = 0; i < fields_.size(); ++i) addKnown(i);
    addClassification();
    for (std::size_t i = 0; i < fields_.size(); ++i)
      if (!used_[i] && fields_[i].name != "_") addExtra(i, fields_[i].name);
    finish();
  }

 private:
  int find(std::string_view plain) const {
    for (std::size_t i = 0; i < fields_.size(); ++i)
      if (!used_[i] && fields_[i].count == 1 && plainName(fields_[i].name) == plain) return static_cast<int>(i);
    return -1;
  }
  bool findThree(std::array<std::string_view, 3> names, std::array<std::size_t, 3>& found) const {
    for (std::size_t k = 0; k < 3; ++k) {
      const int index = find(names[k]);
      if (index < 0) return false;
      found[k] = static_cast<std::size_t>(index);
    }
    return true;
  }
  bool has(std::string_view name) const {
    return std::any_of(attributes_.begin(), attributes_.end(), [&](const Attribute& a) { return a.name == name; });
  }
  void add(std::string_view name, ScalarType type, std::uint16_t components) {
    attributes_.push_back({.name = std::string(name), .type = type, .components = components, .description = {}});
  }
  /// Copies into the attribute added last, `within` bytes behind its start.
  void copy(std::size_t from, std::size_t bytes, std::size_t within = 0) {
    pending_.push_back({attributes_.size() - 1, {.from = from, .to = within, .copyBytes = bytes}});
  }
  void convert(std::size_t field, double shift, double scale, std::size_t within = 0) {
    pending_.push_back({attributes_.size() - 1,
                        {.from = fields_[field].offset,
                         .to = within,
                         .fromType = fields_[field].type,
                         .toType = attributes_.back().type,
                         .scale = scale,
                         .offset = shift * scale}});
  }

  void addColour() {
    std::array<std::size_t, 3> rgb{};
    if (!findThree({"red", "green", "blue"}, rgb) && !findThree({"r", "g", "b"}, rgb)) return;
    add(attribute::kRgb, ScalarType::u16, 3);
    FieldRange range;
    for (const std::size_t field : rgb) range.add(ranges_[field]);
    for (std::size_t k = 0; k < 3; ++k) {
      const ScalarType type = fields_[rgb[k]].type;
      const bool unit = isFloat(type) && !range.empty() && range.max <= 1.0;
      if (type == ScalarType::u16)
        copy(fields_[rgb[k]].offset, 2, 2 * k);
      else
        convert(rgb[k], 0.0, unit ? 255.0 : 1.0, 2 * k);
      used_[rgb[k]] = true;
    }
  }

  void addPackedColour() {
    for (const std::string_view name : {"rgb", "rgba"}) {
      const int found = find(name);
      if (found < 0 || has(attribute::kRgb)) continue;
      const auto index = static_cast<std::size_t>(found);
      if (scalarBytes(fields_[index].type) != 4) continue;
      used_[index] = true;
      add(attribute::kRgb, ScalarType::u16, 3);
      for (std::size_t k = 0; k < 3; ++k)
        pending_.push_back(
            {attributes_.size() - 1, {.from = fields_[index].offset + 2 - k, .to = 2 * k, .toType = ScalarType::u16}});
      if (name == "rgba") {
        add("extra:alpha", ScalarType::u8, 1);
        copy(fields_[index].offset + 3, 1);
      }
    }
  }

  void addIntensity() {
    const int found = find("intensity");
    if (found < 0) return;
    const auto index = static_cast<std::size_t>(found);
    used_[index] = true;
    add(attribute::kIntensity, ScalarType::u16, 1);
    if (fields_[index].type == ScalarType::u16) {
      copy(fields_[index].offset, 2);
    } else if (fields_[index].type == ScalarType::u8) {
      convert(index, 0.0, 1.0);
    } else {
      const IntensityScale scale = intensityScale(ranges_[index]);
      convert(index, scale.shift, scale.scale);
      addExtra(index, "intensity");
    }
  }

  void addNormal() {
    std::array<std::size_t, 3> n{};
    if (!findThree({"nx", "ny", "nz"}, n) && !findThree({"normalx", "normaly", "normalz"}, n)) return;
    if (!std::all_of(n.begin(), n.end(), [&](std::size_t i) { return fields_[i].type == ScalarType::f32; })) return;
    add(attribute::kNormal, ScalarType::f32, 3);
    for (std::size_t k = 0; k < 3; ++k) {
      copy(fields_[n[k]].offset, 4, 4 * k);
      used_[n[k]] = true;
    }
  }

  void addKnown(std::size_t index) {
    const Field& field = fields_[index];
    if (used_[index] || field.count != 1) return;
    const std::string plain = plainName(field.name);
    for (const Known& known : kKnown) {
      if (field.type != known.type || plain != plainName(known.name) || has(known.name)) continue;
      used_[index] = true;
      add(known.name, known.type, 1);
      copy(field.offset, field.bytes());
      return;
    }
  }

  void addClassification() {
    if (has(attribute::kClassification)) return;
    const int found = find("classification");
    if (found < 0) return;
    add(attribute::kClassification, ScalarType::u8, 1);
    convert(static_cast<std::size_t>(found), 0.0, 1.0);
    used_[static_cast<std::size_t>(found)] = true;
    addExtra(static_cast<std::size_t>(found), fields_[static_cast<std::size_t>(found)].name);
  }

  void addExtra(std::size_t index, const std::string& name) {
    const Field& field = fields_[index];
    std::string unique = "extra:" + name;
    for (int n = 2; has(unique); ++n) unique = "extra:" + name + "_" + std::to_string(n);
    add(unique, field.type, static_cast<std::uint16_t>(field.count));
    copy(field.offset, field.bytes());
    used_[index] = true;
  }

  void finish() {
    mapping_.layout_ = PointLayout(std::move(attributes_));
    for (Pending& pending : pending_) {
      pending.step.to += mapping_.layout_.offset(pending.attribute);
      mapping_.steps_.push_back(pending.step);
    }
  }

  struct Pending {
    std::size_t attribute;
    RecordMapping::Step step;  ///< `to` counts from the attribute's own start
  };

  std::span<const Field> fields_;
  std::span<const FieldRange> ranges_;
  std::vector<bool> used_;
  std::vector<Attribute> attributes_;
  std::vector<Pending> pending_;
  RecordMapping& mapping_;
};

RecordMapping::RecordMapping(const std::string& file, std::span<const Field> fields,
                             std::span<const FieldRange> ranges) {
  const AxisFields axes = findAxes(fields);
  for (int axis = 0; axis < 3; ++axis)
    if (axes.index[axis] < 0) throw Error(file, std::string("its points have no field ") + "xyz"[axis]);
  RecordMappingBuilder(fields, ranges, *this).build(axes);
}

glm::dvec3 RecordMapping::position(const std::byte* record) const {
  return {loadScalar(record + axes_[0].offset, axes_[0].type), loadScalar(record + axes_[1].offset, axes_[1].type),
          loadScalar(record + axes_[2].offset, axes_[2].type)};
}

void RecordMapping::attributes(const std::byte* record, std::byte* out) const {
  for (const Step& step : steps_) {
    if (step.copyBytes > 0) {
      std::memcpy(out + step.to, record + step.from, step.copyBytes);
      continue;
    }
    const double value = std::round(loadScalar(record + step.from, step.fromType) * step.scale + step.offset);
    const double top = step.toType == ScalarType::u8 ? 255.0 : 65535.0;
    const auto stored = static_cast<std::uint16_t>(value > 0.0 ? std::min(value, top) : 0.0);  // NaN gives 0
    std::memcpy(out + step.to, &stored, scalarBytes(step.toType));
  }
}

void RecordMapping::append(const std::byte* records, std::size_t recordBytes, std::size_t count,
                           PointBlock& block) const {
  const std::size_t stride = layout_.stride();
  const std::size_t before = block.count();
  block.positions.resize(before + count);
  block.attributes.resize((before + count) * stride);
  for (std::size_t i = 0; i < count; ++i) {
    const std::byte* record = records + i * recordBytes;
    block.positions[before + i] = position(record);
    if (stride > 0) attributes(record, block.attributes.data() + (before + i) * stride);
  }
}

}  // namespace strata
