#include "converter/distribute/attribute_stats.h"

#include <algorithm>
#include <cstring>
#include <limits>

namespace strata {
namespace {

template <typename T>
void minMax(const std::byte* first, std::size_t stride, std::size_t count, std::size_t components,
            AttributeRange& range) {
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
              AttributeRange& range) {
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
  ranges_.resize(layout.attributes().size());
  if (layout.find(attribute::kIntensity) >= 0) intensities_.resize(65536);
  clear();
}

void AttributeStats::clear() {
  for (AttributeRange& range : ranges_) {
    range.min = std::numeric_limits<double>::infinity();
    range.max = -range.min;
  }
  std::fill(intensities_.begin(), intensities_.end(), std::uint64_t{0});
  points_ = 0;
}

void AttributeStats::gather(const std::byte* records, std::size_t stride, std::size_t count,
                            const AttributeVariation& variation) {
  if (count == 0) return;
  points_ += count;
  const auto varies = [&](std::size_t attribute) {
    const auto first = variation.differs.begin() + static_cast<std::ptrdiff_t>(layout_.offset(attribute));
    return std::any_of(first, first + static_cast<std::ptrdiff_t>(layout_.attributes()[attribute].bytes()),
                       [](std::uint8_t differs) { return differs != 0; });
  };
  for (std::size_t a = 0; a < ranges_.size(); ++a) {
    const Attribute& column = layout_.attributes()[a];
    minMaxOf(column.type, records + layout_.offset(a), stride, varies(a) ? count : 1, column.components, ranges_[a]);
  }
  if (intensities_.empty()) return;
  const auto intensity = static_cast<std::size_t>(layout_.find(attribute::kIntensity));
  const std::byte* first = records + layout_.offset(intensity);
  const bool constant = !varies(intensity);
  for (std::size_t i = 0; i < (constant ? 1 : count); ++i) {
    std::uint16_t value;
    std::memcpy(&value, first + i * stride, sizeof value);
    intensities_[value] += constant ? count : 1;
  }
}

void AttributeStats::add(const AttributeStats& other) {
  points_ += other.points_;
  for (std::size_t a = 0; a < ranges_.size(); ++a) {
    ranges_[a].min = std::min(ranges_[a].min, other.ranges_[a].min);
    ranges_[a].max = std::max(ranges_[a].max, other.ranges_[a].max);
  }
  for (std::size_t v = 0; v < intensities_.size(); ++v) intensities_[v] += other.intensities_[v];
}

/// The histogram is written as pairs of (values without points before it, points), ended by a count of 0.
void AttributeStats::write(RecordWriter& record) const {
  record.put(points_);
  for (const AttributeRange& range : ranges_) {
    record.put(range.min);
    record.put(range.max);
  }
  std::uint64_t without = 0;
  for (const std::uint64_t points : intensities_) {
    if (points == 0) {
      ++without;
      continue;
    }
    record.putShort(without);
    record.putShort(points);
    without = 0;
  }
  record.putShort(0);
  record.putShort(0);
}

void AttributeStats::addFrom(RecordReader& record) {
  points_ += record.get<std::uint64_t>();
  for (AttributeRange& range : ranges_) {
    range.min = std::min(range.min, record.get<double>());
    range.max = std::max(range.max, record.get<double>());
  }
  std::size_t value = 0;
  for (;;) {
    value += record.getShort();
    const std::uint64_t points = record.getShort();
    if (points == 0) break;
    if (value >= intensities_.size()) throw Error("a histogram of the journal is too long");
    intensities_[value++] += points;
  }
}

std::vector<AttributeRange> AttributeStats::ranges() const {
  std::vector<AttributeRange> result = ranges_;
  for (AttributeRange& range : result) {
    if (!(range.min <= range.max)) range.min = range.max = 0.0;
    range.low = range.min;
    range.high = range.max;
  }
  if (intensities_.empty()) return result;
  AttributeRange& intensity = result[static_cast<std::size_t>(layout_.find(attribute::kIntensity))];
  std::uint64_t before = 0;
  bool lowFound = false;
  for (std::size_t value = 0; value < intensities_.size(); ++value) {
    before += intensities_[value];
    if (!lowFound && before * 100 >= points_) {
      intensity.low = static_cast<double>(value);
      lowFound = true;
    }
    if (before * 100 >= points_ * 99) {
      intensity.high = static_cast<double>(value);
      break;
    }
  }
  return result;
}

}  // namespace strata
