#include "io/las/las_export_layout.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/error.h"
#include "io/las/las_header.h"
#include "io/las/las_vlr.h"

namespace strata {
namespace {

constexpr double kSmallestInteger = std::numeric_limits<std::int32_t>::min();
constexpr double kLargestInteger = std::numeric_limits<std::int32_t>::max();
/// Two grids count as the same when they are apart by at most this share of a step, which is what doubles lose at 1e7
/// m.
constexpr double kSameGrid = 1e-3;

/// The largest value of an attribute in the store; 0 when there is no such attribute.
double largest(const StoreInfo& info, std::string_view name) {
  const int index = info.layout.find(name);
  return index < 0 || static_cast<std::size_t>(index) >= info.ranges.size()
             ? 0.0
             : info.ranges[static_cast<std::size_t>(index)].max;
}

bool sameType(const Attribute& a, const Attribute& b) { return a.type == b.type && a.components == b.components; }

/// The copies that put every attribute of `from` where `to` has it; nothing when one of them has no place there.
std::optional<std::vector<LasExportLayout::Copy>> copiesBetween(const PointLayout& from, const PointLayout& to) {
  std::vector<LasExportLayout::Copy> copies;
  for (std::size_t i = 0; i < from.attributes().size(); ++i) {
    const Attribute& attribute = from.attributes()[i];
    if (attribute.isInternal()) continue;
    const int place = to.find(attribute.name);
    if (place < 0 || !sameType(attribute, to.attributes()[static_cast<std::size_t>(place)])) return {};
    copies.push_back({from.offset(i), to.offset(static_cast<std::size_t>(place)), attribute.bytes()});
  }
  return copies;
}

/// Formats 0 to 5 have 5 bits for the class, 3 for return numbers and none for overlap and scanner channel.
bool fitsBitFields(const StoreInfo& info, int pointFormat) {
  constexpr double kSharedFlags = 7;  // bits 6 and 7 have a field too, but a maximum does not tell them from 3 to 5
  if (pointFormat < 6 && (!info.las || info.las->pointFormat >= 6) && largest(info, attribute::kFlags) > kSharedFlags)
    return false;
  return pointFormat >= 6 ||
         (largest(info, attribute::kClassification) <= 31 && largest(info, attribute::kReturnNumber) <= 7 &&
          largest(info, attribute::kNumberOfReturns) <= 7);
}

/// The source's own format; nothing when an attribute has no place in it.
std::optional<LasExportLayout> sourceLayout(const StoreInfo& info, std::uint64_t points) {
  if (!info.las || !fitsBitFields(info, info.las->pointFormat)) return {};
  if (info.las->versionMinor < 4 && points > std::numeric_limits<std::uint32_t>::max()) return {};
  LasExportLayout out;
  out.meta = *info.las;
  out.format = {info.las->pointFormat, info.las->recordBytes};
  const PointLayout layout = lasLayout(out.format, info.las->vlrs);
  auto copies = copiesBetween(info.layout, layout);
  if (!copies) return {};
  out.copies = std::move(*copies);
  return out;
}

/// The smallest of formats 6 to 8 that has a field for the colours.
int modernFormat(const StoreInfo& info) {
  const bool nir = info.layout.find(attribute::kNir) >= 0, rgb = info.layout.find(attribute::kRgb) >= 0;
  return nir ? 8 : rgb ? 7 : 6;
}

/// LAS 1.4 with records of the given format. Attributes that it has no field for become extra bytes.
LasExportLayout modernLayout(const StoreInfo& info, int pointFormat) {
  LasExportLayout out;
  out.format.pointFormat = pointFormat;
  out.format.recordBytes = lasFormatBytes(pointFormat);
  const PointLayout fields = lasLayout(out.format, {});
  const int angle = fields.find(attribute::kScanAngle);
  if (angle >= 0) out.angleAt = fields.offset(static_cast<std::size_t>(angle));
  std::size_t end = fields.stride();
  std::vector<Attribute> extra;
  for (std::size_t i = 0; i < info.layout.attributes().size(); ++i) {
    const Attribute& attribute = info.layout.attributes()[i];
    if (attribute.isInternal()) continue;
    const int place = fields.find(attribute.name);
    if (place >= 0 && sameType(attribute, fields.attributes()[static_cast<std::size_t>(place)])) {
      out.copies.push_back({info.layout.offset(i), fields.offset(static_cast<std::size_t>(place)), attribute.bytes()});
    } else if (angle >= 0 && attribute.name == attribute::kScanAngleRank && attribute.type == ScalarType::i8) {
      out.rankAt = static_cast<int>(info.layout.offset(i));
    } else {
      out.copies.push_back({info.layout.offset(i), end, attribute.bytes()});
      end += attribute.bytes();
      extra.push_back(attribute);
    }
  }
  out.format.recordBytes = static_cast<std::uint16_t>(out.format.recordBytes + (end - fields.stride()));

  if (info.las) out.meta = *info.las;
  out.meta.versionMinor = 4;
  out.meta.pointFormat = static_cast<std::uint8_t>(out.format.pointFormat);
  out.meta.recordBytes = out.format.recordBytes;
  std::erase_if(out.meta.vlrs, [](const LasMeta::Vlr& vlr) { return isExtraBytes(vlr) || isCrs(vlr); });
  out.meta.globalEncoding = static_cast<std::uint16_t>(out.meta.globalEncoding & ~kWktBit);
  if (!info.crs.empty()) {
    out.meta.vlrs.push_back(encodeCrs(info.crs));
    if (!info.crs.starts_with("EPSG:")) out.meta.globalEncoding |= kWktBit;
  }
  if (!extra.empty()) out.meta.vlrs.push_back(encodeExtraBytes(extra));
  return out;
}

/// The smallest and the largest integer of the points along an axis of the store's grid.
struct Reach {
  double first, last;
};
Reach reachOf(const StoreInfo& info, const Box& bounds, int axis) {
  if (bounds.empty()) return {0.0, 0.0};
  const double scale = info.grid.scale[axis], offset = info.grid.offset[axis];
  return {std::round((bounds.min[axis] - offset) / scale), std::round((bounds.max[axis] - offset) / scale)};
}

/// Takes the source's grid, if it is the store's grid shifted by whole steps and its integers hold all points. The
/// store of a single source may have finer steps than the source (docs/decisions/0001-integer-grid.md); all points lie
/// on the coarser grid then.
bool takeSourceGrid(const StoreInfo& info, const Box& bounds, LasExportLayout& out) {
  if (!info.las) return false;
  for (int axis = 0; axis < 3; ++axis) {
    const double ratio = info.las->scale[axis] / info.grid.scale[axis];
    const double divide = std::round(ratio);
    if (!(std::abs(ratio - divide) <= kSameGrid * 1e-3) || divide < 1.0 || (divide > 1.0 && info.sources.size() != 1))
      return false;
    const double steps = (info.grid.offset[axis] - info.las->offset[axis]) / info.grid.scale[axis];
    const double shift = std::round(steps);
    if (!(std::abs(steps - shift) <= kSameGrid) || std::abs(shift) > 0x1p53) return false;
    const Reach reach = reachOf(info, bounds, axis);
    if ((reach.first + shift) / divide < kSmallestInteger || (reach.last + shift) / divide > kLargestInteger)
      return false;
    out.shift[axis] = static_cast<std::int64_t>(shift);
    out.divide[axis] = static_cast<std::int64_t>(divide);
  }
  out.meta.scale = info.las->scale;
  out.meta.offset = info.las->offset;
  return true;
}

/// Takes the store's own grid, and moves its zero when the integers would not fit 32 bits.
void takeStoreGrid(const std::string& file, const StoreInfo& info, const Box& bounds, LasExportLayout& out) {
  out.meta.scale = info.grid.scale;
  for (int axis = 0; axis < 3; ++axis) {
    const Reach reach = reachOf(info, bounds, axis);
    double shift = 0.0;
    if (reach.first < kSmallestInteger || reach.last > kLargestInteger)
      shift = -std::floor((reach.first + reach.last) / 2);
    if (reach.first + shift < kSmallestInteger || reach.last + shift > kLargestInteger)
      throw Error(file, "the points span too many steps for LAS along axis " + std::string(1, "xyz"[axis]) +
                            ", found " + std::to_string(reach.last - reach.first) + " steps of " +
                            std::to_string(info.grid.scale[axis]) + " (expected less than 2^32)");
    out.shift[axis] = static_cast<std::int64_t>(shift);
    out.divide[axis] = 1;
    out.meta.offset[axis] = info.grid.offset[axis] - shift * info.grid.scale[axis];
  }
}

}  // namespace

LasExportLayout chooseLasExportLayout(const std::string& file, const StoreInfo& info, const ExportedPoints& points,
                                      std::optional<int> pointFormat) {
  if (pointFormat && !fitsBitFields(info, *pointFormat))
    throw Error(file, "the points do not fit point format " + std::to_string(*pointFormat) +
                          ", found a class above 31, a return number above 7 or flags (expected formats 6 to 8)");
  std::optional<LasExportLayout> source;
  if (!pointFormat) source = sourceLayout(info, points.count);
  LasExportLayout out = source ? std::move(*source) : modernLayout(info, pointFormat.value_or(modernFormat(info)));
  if (lasFormatBytes(out.format.pointFormat) > out.format.recordBytes)
    throw Error(file,
                "the attributes are too large for a LAS record, found more than 65535 bytes (expected at most 65535)");
  if (!takeSourceGrid(info, points.bounds, out)) takeStoreGrid(file, info, points.bounds, out);
  if (!info.program.empty()) out.meta.generatingSoftware = info.program;
  std::size_t next = 0;
  out.sameRecords = out.rankAt < 0 && info.layout.stride() == lasStride(out.format) &&
                    std::all_of(out.copies.begin(), out.copies.end(), [&next](const LasExportLayout::Copy& copy) {
                      const bool inPlace = copy.from == next && copy.to == next;
                      next += copy.bytes;
                      return inPlace;
                    });
  return out;
}

}  // namespace strata
