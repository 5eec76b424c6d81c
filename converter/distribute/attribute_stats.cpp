#include "converter/distribute/attribute_stats.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "core/error.h"

namespace strata {
namespace {

template <typename T>
void minMax(const std::byte* first, std::size_t stride, std::size_t count, std::size_t components, ValueRange& range) {
  T low = std::numeric_limits<T>::max();
  T high = std::numeric_limits<T>::lowest();
  for (std::size_t c = 0; c < components; ++c)
    for (std::size_t i = 0; i < count; ++i) {
      T value;
      std::memcpy(&value, first + i * stride + c * sizeof(T), sizeof(T));
      low = value < low ? value : low;  // a NaN compares false and is passed over
      high = value > high ? value : high;
    }
  if (!(low <= high)) return;
  range.min = std::min(range.min, static_cast<double>(low));
  range.max = std::max(range.max, static_cast<double>(high));
}

void minMaxOf(ScalarType type, const std::byte* first, std::size_t stride, std::size_t count, std::size_t components,
              ValueRange& range) {
  switch (type) {
    case ScalarType::u8:
      return minMax<std::uint8_t>(first, stride, count, components, range);
    case ScalarType::i8:
      return minMax<std::int8_t>(first, stride, count, components, range);
    case ScalarType::u16:
      return minMax<std::uint16_t>(first, stride, count, components, range);
    case ScalarType::i16:
      return minMax<std::int16_t>(first, stride, count, components, range);
    case ScalarType::u32:
      return minMax<std::uint32_t>(first, stride, count, components, range);
    case ScalarType::i32:
      return minMax<std::int32_t>(first, stride, count, components, range);
    case ScalarType::u64:
      return minMax<std::uint64_t>(first, stride, count, components, range);
    case ScalarType::i64:
      return minMax<std::int64_t>(first, stride, count, components, range);
    case ScalarType::f32:
      return minMax<float>(first, stride, count, components, range);
    case ScalarType::f64:
      return minMax<double>(first, stride, count, components, range);
  }
}

}  // namespace

AttributeStats::AttributeStats(const PointLayout& layout) : layout_(layout) {
  if (layout.find(attribute::kIntensity) >= 0) counts_.intensities.resize(65536);
  clear();
}

void AttributeStats::clear() {
  counts_.ranges.assign(layout_.attributes().size(), ValueRange{});
  std::fill(counts_.intensities.begin(), counts_.intensities.end(), std::uint64_t{0});
  counts_.points = 0;
}

void AttributeStats::gather(const std::byte* records, std::size_t stride, std::size_t count,
                            const AttributeVariation& variation) {
  if (count == 0) return;
  counts_.points += count;
  const auto varies = [&](std::size_t attribute) {
    const auto first = variation.differs.begin() + static_cast<std::ptrdiff_t>(layout_.offset(attribute));
    return std::any_of(first, first + static_cast<std::ptrdiff_t>(layout_.attributes()[attribute].bytes()),
                       [](std::uint8_t differs) { return differs != 0; });
  };
  for (std::size_t a = 0; a < counts_.ranges.size(); ++a) {
    const Attribute& column = layout_.attributes()[a];
    minMaxOf(column.type, records + layout_.offset(a), stride, varies(a) ? count : 1, column.components,
             counts_.ranges[a]);
  }
  if (counts_.intensities.empty()) return;
  const auto intensity = static_cast<std::size_t>(layout_.find(attribute::kIntensity));
  const std::byte* first = records + layout_.offset(intensity);
  const bool constant = !varies(intensity);
  for (std::size_t i = 0; i < (constant ? 1 : count); ++i) {
    std::uint16_t value;
    std::memcpy(&value, first + i * stride, sizeof value);
    counts_.intensities[value] += constant ? count : 1;
  }
}

void AttributeStats::add(const AttributeCounts& counts) {
  if (counts.ranges.size() != counts_.ranges.size() || counts.intensities.size() != counts_.intensities.size())
    throw Error("the journal tells of other attributes than the scans have");
  counts_.points += counts.points;
  for (std::size_t a = 0; a < counts_.ranges.size(); ++a) {
    counts_.ranges[a].min = std::min(counts_.ranges[a].min, counts.ranges[a].min);
    counts_.ranges[a].max = std::max(counts_.ranges[a].max, counts.ranges[a].max);
  }
  for (std::size_t v = 0; v < counts_.intensities.size(); ++v) counts_.intensities[v] += counts.intensities[v];
}

std::vector<AttributeRange> AttributeStats::ranges() const {
  std::vector<AttributeRange> result(counts_.ranges.size());
  for (std::size_t a = 0; a < result.size(); ++a) {
    const ValueRange& found = counts_.ranges[a];
    if (found.min <= found.max) {
      result[a].min = found.min;
      result[a].max = found.max;
    }
    result[a].low = result[a].min;
    result[a].high = result[a].max;
  }
  if (counts_.intensities.empty()) return result;
  // The first and the last hundredth of the points do not count towards low and high.
  AttributeRange& intensity = result[static_cast<std::size_t>(layout_.find(attribute::kIntensity))];
  std::uint64_t before = 0;
  bool lowFound = false;
  for (std::size_t value = 0; value < counts_.intensities.size(); ++value) {
    before += counts_.intensities[value];
    if (!lowFound && before * 100 >= counts_.points) {
      intensity.low = static_cast<double>(value);
      lowFound = true;
    }
    if (before * 100 >= counts_.points * 99) {
      intensity.high = static_cast<double>(value);
      break;
    }
  }
  return result;
}

}  // namespace strata
