#include "converter/distribute/point_packer.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "converter/memory/fixed_size.h"

namespace strata {
namespace {

/// Finds the whole number nearest to a ratio; true where the two differ by so little that 2^31 times the difference is
/// below a quarter, so that no product of a LAS integer is rounded wrongly.
bool wholeFactor(double ratio, std::int64_t& whole) {
  const double rounded = std::round(ratio);
  whole = static_cast<std::int64_t>(rounded);
  return std::abs(rounded) >= 1.0 && std::abs(rounded) < 65536.0 && std::abs(ratio - rounded) * 2147483648.0 < 0.25;
}

}  // namespace

PackedFormat packedFormat(const Survey& survey) { return {survey.cubeBits > 32, survey.layout.stride()}; }

PointPacker::PointPacker(const Survey& survey, const PackedFormat& format, const PointSource& source,
                         const SourceMapping& mapping)
    : survey_(survey),
      format_(format),
      source_(source),
      mapping_(mapping),
      sourceStride_(source.info().layout.stride()) {
  integers_ = findIntegerAxes(source);
}

bool PointPacker::findIntegerAxes(const PointSource& source) {
  if (!source.info().las) return false;
  for (int axis = 0; axis < 3; ++axis) {
    IntegerAxis& out = axes_[static_cast<std::size_t>(axis)];
    const double shift = mapping_.originDelta[axis] / survey_.grid.scale[axis];
    if (!wholeFactor(source.info().las->scale[axis] / survey_.grid.scale[axis], out.factor)) return false;
    if (!(std::abs(shift) < 1e15) || std::abs(shift - std::round(shift)) > 0.01) return false;
    out.shift = static_cast<std::int64_t>(std::round(shift));
  }
  return true;
}

/// Packs LAS integers by whole numbers alone, without a detour over coordinates.
template <typename Grid>
void PointPacker::packIntegers() {
  const std::size_t stride = format_.stride();
  const std::uint64_t end = std::uint64_t{1} << survey_.cubeBits;
  std::uint64_t low[3], high[3];
  std::fill(low, low + 3, std::numeric_limits<std::uint64_t>::max());
  std::fill(high, high + 3, std::uint64_t{0});
  std::byte* record = packed_.data();
  for (const glm::ivec3& point : block_.integers) {
    Grid grid[3];
    for (int axis = 0; axis < 3; ++axis) {
      const IntegerAxis& a = axes_[static_cast<std::size_t>(axis)];
      const auto value = static_cast<std::uint64_t>(a.factor * point[axis] + a.shift);  // below 0: very large
      low[axis] = std::min(low[axis], value);
      high[axis] = std::max(high[axis], value);
      grid[axis] = static_cast<Grid>(value);
    }
    std::memcpy(record, grid, sizeof grid);
    record += stride;
  }
  count_ = block_.integers.size();
  std::copy_n(low, 3, low_.begin());
  std::copy_n(high, 3, high_.begin());
  outside_ = count_ > 0 && std::any_of(high, high + 3, [&](std::uint64_t v) { return v >= end; });
}

template <typename Grid>
void PointPacker::packDoubles() {
  const std::size_t stride = format_.stride();
  const double end = std::ldexp(1.0, survey_.cubeBits);
  const glm::dvec3 perStep = 1.0 / survey_.grid.scale;
  low_.fill(std::numeric_limits<std::uint64_t>::max());
  high_.fill(0);
  std::byte* record = packed_.data();
  for (std::size_t i = 0; i < block_.positions.size(); ++i) {
    const glm::dvec3 steps = glm::floor((block_.positions[i] + mapping_.originDelta) * perStep + 0.5);
    const bool inside =
        steps.x >= 0.0 && steps.x < end && steps.y >= 0.0 && steps.y < end && steps.z >= 0.0 && steps.z < end;
    if (!inside) {
      outside_ = outside_ || std::isfinite(steps.x + steps.y + steps.z);
      if (skipped_++ == 0) {
        kept_.resize(i);
        for (std::size_t k = 0; k < i; ++k) kept_[k] = static_cast<std::uint32_t>(k);
      }
      continue;
    }
    if (skipped_ > 0) kept_.push_back(static_cast<std::uint32_t>(i));
    Grid grid[3];
    for (int axis = 0; axis < 3; ++axis) {
      grid[axis] = static_cast<Grid>(static_cast<std::int64_t>(steps[axis]));
      low_[static_cast<std::size_t>(axis)] = std::min<std::uint64_t>(low_[static_cast<std::size_t>(axis)], grid[axis]);
      high_[static_cast<std::size_t>(axis)] =
          std::max<std::uint64_t>(high_[static_cast<std::size_t>(axis)], grid[axis]);
    }
    std::memcpy(record, grid, sizeof grid);
    record += stride;
  }
  count_ = block_.positions.size() - skipped_;
}

template <typename Grid>
void PointPacker::addAttributes() {
  const std::size_t stride = format_.stride();
  std::byte* to = packed_.data() + 3 * sizeof(Grid);
  const std::byte* from = block_.attributes.data();
  const auto index = [&](std::size_t i) { return skipped_ == 0 ? i : kept_[i]; };
  if (mapping_.sameLayout && skipped_ == 0) {
    withFixedSize<40>(format_.attributeBytes, [&](auto bytes) {
      for (std::size_t i = 0; i < count_; ++i)
        if (bytes > 0) std::memcpy(to + i * stride, from + i * bytes, bytes);
    });
    return;
  }
  for (std::size_t i = 0; i < count_; ++i) {
    const std::byte* record = from + index(i) * sourceStride_;
    std::byte* out = to + i * stride;
    std::memset(out, 0, format_.attributeBytes);
    for (const SourceMapping::Column& c : mapping_.columns) std::memcpy(out + c.to, record + c.from, c.bytes);
    if (mapping_.colourShiftAt >= 0) out[mapping_.colourShiftAt] = static_cast<std::byte>(mapping_.colourShift);
  }
}

std::unique_ptr<PointReader> PointPacker::open(std::size_t part) const {
  return integers_ ? source_.openIntegers(part) : source_.openPart(part);
}

bool PointPacker::read(PointReader& reader, std::size_t maxPoints) {
  count_ = skipped_ = 0;
  outside_ = false;
  if (!reader.read(block_, maxPoints)) return false;
  packed_.resize(block_.count() * format_.stride());
  const auto pack = [&]<typename Grid>(Grid) {
    if (!block_.integers.empty())
      packIntegers<Grid>();
    else
      packDoubles<Grid>();
    addAttributes<Grid>();
  };
  if (format_.wide)
    pack(std::uint64_t{});
  else
    pack(std::uint32_t{});
  return true;
}

}  // namespace strata
