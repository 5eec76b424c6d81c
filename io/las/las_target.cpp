#include "io/las/las_target.h"

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
/// Share of a step by which two grids may be apart and still be called the same: what doubles lose at 1e7 m.
constexpr double kSameGrid = 1e-3;

/// Largest value of an attribute over the store; 0 where it has none of this name.
double largest(const StoreInfo& info, std::string_view name) {
  const int index = info.layout.find(name);
  return index < 0 || static_cast<std::size_t>(index) >= info.ranges.size()
             ? 0.0
             : info.ranges[static_cast<std::size_t>(index)].max;
}

bool sameType(const Attribute& a, const Attribute& b) { return a.type == b.type && a.components == b.components; }

/// Where every attribute of `from` goes in `to`; nothing when one has no place.
std::optional<std::vector<LasTarget::Copy>> copiesBetween(const PointLayout& from, const PointLayout& to) {
  std::vector<LasTarget::Copy> copies;
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

/// The source's format, where every attribute has a place in it.
std::optional<LasTarget> sourceTarget(const StoreInfo& info, std::uint64_t points) {
  if (!info.las || !fitsBitFields(info, info.las->pointFormat)) return {};
  if (info.las->versionMinor < 4 && points > std::numeric_limits<std::uint32_t>::max()) return {};
  LasTarget target;
  target.meta = *info.las;
  target.format = {info.las->pointFormat, info.las->recordBytes};
  const PointLayout layout = lasLayout(target.format, info.las->vlrs);
  auto copies = copiesBetween(info.layout, layout);
  if (!copies) return {};
  target.copies = std::move(*copies);
  return target;
}

/// The smallest of formats 6 to 8 that has a field for the colours.
int modernFormat(const StoreInfo& info) {
  const bool nir = info.layout.find(attribute::kNir) >= 0, rgb = info.layout.find(attribute::kRgb) >= 0;
  return nir ? 8 : rgb ? 7 : 6;
}

/// LAS 1.4 with records of the given format; what it has no field for becomes extra bytes.
LasTarget modernTarget(const StoreInfo& info, int pointFormat) {
  LasTarget target;
  target.format.pointFormat = pointFormat;
  target.format.recordBytes = lasFormatBytes(pointFormat);
  const PointLayout fields = lasLayout(target.format, {});
  const int angle = fields.find(attribute::kScanAngle);
  if (angle >= 0) target.angleAt = fields.offset(static_cast<std::size_t>(angle));
  std::size_t end = fields.stride();
  std::vector<Attribute> extra;
  for (std::size_t i = 0; i < info.layout.attributes().size(); ++i) {
    const Attribute& attribute = info.layout.attributes()[i];
    if (attribute.isInternal()) continue;
    const int place = fields.find(attribute.name);
    if (place >= 0 && sameType(attribute, fields.attributes()[static_cast<std::size_t>(place)])) {
      target.copies.push_back(
          {info.layout.offset(i), fields.offset(static_cast<std::size_t>(place)), attribute.bytes()});
    } else if (angle >= 0 && attribute.name == attribute::kScanAngleRank && attribute.type == ScalarType::i8) {
      target.rankAt = static_cast<int>(info.layout.offset(i));
    } else {
      target.copies.push_back({info.layout.offset(i), end, attribute.bytes()});
      end += attribute.bytes();
      extra.push_back(attribute);
    }
  }
  target.format.recordBytes = static_cast<std::uint16_t>(target.format.recordBytes + (end - fields.stride()));

  if (info.las) target.meta = *info.las;
  target.meta.versionMinor = 4;
  target.meta.pointFormat = static_cast<std::uint8_t>(target.format.pointFormat);
  target.meta.recordBytes = target.format.recordBytes;
  std::erase_if(target.meta.vlrs, [](const LasMeta::Vlr& vlr) { return isExtraBytes(vlr) || isCrs(vlr); });
  target.meta.globalEncoding = static_cast<std::uint16_t>(target.meta.globalEncoding & ~kWktBit);
  if (!info.crs.empty()) {
    target.meta.vlrs.push_back(encodeCrs(info.crs));
    if (!info.crs.starts_with("EPSG:")) target.meta.globalEncoding |= kWktBit;
  }
  if (!extra.empty()) target.meta.vlrs.push_back(encodeExtraBytes(extra));
  return target;
}

/// Smallest and largest integer of the store's grid along an axis.
struct Reach {
  double first, last;
};
Reach reachOf(const StoreInfo& info, const Box& bounds, int axis) {
  if (bounds.empty()) return {0.0, 0.0};
  const double scale = info.grid.scale[axis], offset = info.grid.offset[axis];
  return {std::round((bounds.min[axis] - offset) / scale), std::round((bounds.max[axis] - offset) / scale)};
}

/// True when the source's grid is the store's, shifted by whole steps, and holds all points. The store of a single
/// source may have finer steps than it (docs/decisions/0001-integer-grid.md): all points lie on the coarser grid then.
bool takeSourceGrid(const StoreInfo& info, const Box& bounds, LasTarget& target) {
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
    target.shift[axis] = static_cast<std::int64_t>(shift);
    target.divide[axis] = static_cast<std::int64_t>(divide);
  }
  target.meta.scale = info.las->scale;
  target.meta.offset = info.las->offset;
  return true;
}

/// The store's own grid, its zero moved where the integers would not fit 32 bits.
void takeStoreGrid(const std::string& file, const StoreInfo& info, const Box& bounds, LasTarget& target) {
  target.meta.scale = info.grid.scale;
  for (int axis = 0; axis < 3; ++axis) {
    const Reach reach = reachOf(info, bounds, axis);
    double shift = 0.0;
    if (reach.first < kSmallestInteger || reach.last > kLargestInteger)
      shift = -std::floor((reach.first + reach.last) / 2);
    if (reach.first + shift < kSmallestInteger || reach.last + shift > kLargestInteger)
      throw Error(file, "the points span too many steps for LAS along axis " + std::string(1, "xyz"[axis]) +
                            ", found " + std::to_string(reach.last - reach.first) + " steps of " +
                            std::to_string(info.grid.scale[axis]) + " (expected less than 2^32)");
    target.shift[axis] = static_cast<std::int64_t>(shift);
    target.divide[axis] = 1;
    target.meta.offset[axis] = info.grid.offset[axis] - shift * info.grid.scale[axis];
  }
}

}  // namespace

LasTarget chooseLasTarget(const std::string& file, const StoreInfo& info, std::uint64_t points, const Box& bounds,
                          std::optional<int> pointFormat) {
  if (pointFormat && !fitsBitFields(info, *pointFormat))
    throw Error(file, "the points do not fit point format " + std::to_string(*pointFormat) +
                          ", found a class above 31, a return number above 7 or flags (expected formats 6 to 8)");
  std::optional<LasTarget> source;
  if (!pointFormat) source = sourceTarget(info, points);
  LasTarget target = source ? std::move(*source) : modernTarget(info, pointFormat.value_or(modernFormat(info)));
  if (lasFormatBytes(target.format.pointFormat) > target.format.recordBytes)
    throw Error(file,
                "the attributes are too large for a LAS record, found more than 65535 bytes (expected at most 65535)");
  if (!takeSourceGrid(info, bounds, target)) takeStoreGrid(file, info, bounds, target);
  if (!info.program.empty()) target.meta.generatingSoftware = info.program;
  std::size_t next = 0;
  target.sameRecords = target.rankAt < 0 && info.layout.stride() == lasStride(target.format) &&
                       std::all_of(target.copies.begin(), target.copies.end(), [&next](const LasTarget::Copy& copy) {
                         const bool inPlace = copy.from == next && copy.to == next;
                         next += copy.bytes;
                         return inPlace;
                       });
  return target;
}

}  // namespace strata
