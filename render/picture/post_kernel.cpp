#include "render/picture/post_kernel.h"

#include <algorithm>
#include <cmath>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/picture/post_kernel.cpp"  // compiled once for each instruction set
#include <hwy/foreach_target.h>
// These two come behind foreach_target.h, because they are compiled for one target at a time.
#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace strata {
namespace HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

void dilate(const PackedPixel* from, PackedPixel* to, std::size_t width, std::size_t size) {
  const hn::ScalableTag<PackedPixel> tag;
  const std::size_t before = size / 2, after = (size - 1) / 2;
  const auto one = [&](std::size_t x) {
    const std::size_t first = x - std::min(x, before), last = std::min(x + after, width - 1);
    to[x] = *std::min_element(from + first, from + last + 1);
  };
  std::size_t x = 0;
  for (; x < std::min(before, width); ++x) one(x);
  for (; x + hn::Lanes(tag) + after <= width; x += hn::Lanes(tag)) {
    auto least = hn::LoadU(tag, from + x - before);
    for (std::size_t i = 1; i < size; ++i) least = hn::Min(least, hn::LoadU(tag, from + x - before + i));
    hn::StoreU(least, tag, to + x);
  }
  for (; x < width; ++x) one(x);
}

void lower(const PackedPixel* from, PackedPixel* to, std::size_t width) {
  const hn::ScalableTag<PackedPixel> tag;
  std::size_t x = 0;
  for (; x + hn::Lanes(tag) <= width; x += hn::Lanes(tag))
    hn::StoreU(hn::Min(hn::LoadU(tag, from + x), hn::LoadU(tag, to + x)), tag, to + x);
  for (; x < width; ++x) to[x] = std::min(from[x], to[x]);
}

void log2All(const float* depth, float* to, std::size_t width) {
  const hn::ScalableTag<float> tag;
  const auto infinite = hn::Set(tag, std::numeric_limits<float>::infinity());
  const auto logOf = [&](auto value) {
    const auto safe = hn::Min(hn::Max(value, hn::Set(tag, 1e-30f)), hn::Set(tag, 1e30f));
    return hn::IfThenElse(hn::Eq(value, infinite), infinite, hn::Log2(tag, safe));
  };
  std::size_t x = 0;
  for (; x + hn::Lanes(tag) <= width; x += hn::Lanes(tag)) hn::StoreU(logOf(hn::LoadU(tag, depth + x)), tag, to + x);
  if (x == width) return;
  HWY_ALIGN float rest[HWY_MAX_BYTES / sizeof(float)] = {};
  std::copy(depth + x, depth + width, rest);
  hn::Store(logOf(hn::Load(tag, rest)), tag, rest);
  std::copy(rest, rest + (width - x), to + x);
}

constexpr hn::ScalableTag<float> kFloat{};
constexpr std::size_t kMostLanes = HWY_MAX_BYTES / sizeof(float);

/// Where a vector of pixels finds the depths around it: at[row][side], from the row above and the left on.
struct Neighbours {
  const float* at[3][3];
};

/// Shades one vector of pixels. All pixels are shaded here, so that a colour does not depend on the pixel's column.
HWY_INLINE void shadeVector(const Neighbours& near, float gain, std::uint32_t* colours) {
  const hn::RebindToUnsigned<decltype(kFloat)> word;
  const hn::RebindToSigned<decltype(kFloat)> integer;
  const auto here = hn::LoadU(kFloat, near.at[1][1]);
  const auto none = hn::Zero(kFloat);
  const auto drawn = hn::Lt(here, hn::Set(kFloat, std::numeric_limits<float>::infinity()));
  if (hn::AllFalse(kFloat, drawn)) return;
  const auto ahead = [&](const float* at) { return hn::Max(none, here - hn::LoadU(kFloat, at)); };
  auto inFront = ahead(near.at[1][0]) + ahead(near.at[1][2]);
  for (const auto& row : {near.at[0], near.at[2]}) inFront = inFront + ahead(row[0]) + ahead(row[1]) + ahead(row[2]);
  const auto factor = hn::Exp(kFloat, hn::Max(hn::Set(kFloat, -87.0f), none - inFront * hn::Set(kFloat, gain)));
  const auto colour = hn::LoadU(word, colours);
  auto result = hn::And(colour, hn::Set(word, 0xff000000u));
  const auto channel = [&](auto shifted) {
    const auto value = hn::ConvertTo(kFloat, hn::BitCast(integer, hn::And(shifted, hn::Set(word, 255u))));
    return hn::BitCast(word, hn::ConvertTo(integer, value * factor + hn::Set(kFloat, 0.5f)));
  };
  result = hn::Or(result, channel(colour));
  result = hn::Or(result, hn::ShiftLeft<8>(channel(hn::ShiftRight<8>(colour))));
  result = hn::Or(result, hn::ShiftLeft<16>(channel(hn::ShiftRight<16>(colour))));
  hn::StoreU(hn::IfThenElse(hn::RebindMask(word, drawn), result, colour), word, colours);
}

/// Shades at most one vector of pixels near the ends of a row. Neighbours beyond an end are replaced by the end's
/// pixel.
void shadeAtEnd(const EdlRows& r, std::size_t begin, std::size_t end, float gain, std::uint32_t* colours) {
  float depths[3][3][kMostLanes];
  std::uint32_t some[kMostLanes] = {};
  Neighbours near;
  const float* const rows[3] = {r.above, r.here, r.below};
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t side = 0; side < 3; ++side) {
      near.at[row][side] = depths[row][side];
      std::fill_n(depths[row][side], kMostLanes, std::numeric_limits<float>::infinity());
      for (std::size_t x = begin; x < end; ++x) {
        const std::size_t columns[3] = {x - std::min(x, r.apart), x, std::min(x + r.apart, r.width - 1)};
        depths[row][side][x - begin] = rows[row][columns[side]];
      }
    }
  std::copy(colours + begin, colours + end, some);
  shadeVector(near, gain, some);
  std::copy(some, some + (end - begin), colours + begin);
}

void shade(const EdlRows& r, std::size_t begin, std::size_t end, float gain, std::uint32_t* colours) {
  const std::size_t lanes = hn::Lanes(kFloat);
  const std::size_t safeEnd = std::min(end, r.width - std::min(r.width, r.apart));
  std::size_t x = begin;
  for (std::size_t next; x < std::min(end, r.apart); x = next) {
    next = std::min({x + lanes, end, r.apart});
    shadeAtEnd(r, x, next, gain, colours);
  }
  for (; x + lanes <= safeEnd; x += lanes) {
    Neighbours near;
    const float* const rows[3] = {r.above + x, r.here + x, r.below + x};
    for (std::size_t row = 0; row < 3; ++row) {
      near.at[row][0] = rows[row] - r.apart;
      near.at[row][1] = rows[row];
      near.at[row][2] = rows[row] + r.apart;
    }
    shadeVector(near, gain, colours + x);
  }
  for (std::size_t next; x < end; x = next) {
    next = std::min(x + lanes, end);
    shadeAtEnd(r, x, next, gain, colours);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace strata
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace strata {

HWY_EXPORT(dilate);
HWY_EXPORT(lower);
HWY_EXPORT(log2All);
HWY_EXPORT(shade);

void dilateRow(const PackedPixel* from, PackedPixel* to, std::size_t width, std::size_t size) {
  HWY_DYNAMIC_DISPATCH(dilate)(from, to, width, size);
}

void lowerRow(const PackedPixel* from, PackedPixel* to, std::size_t width) {
  HWY_DYNAMIC_DISPATCH(lower)(from, to, width);
}

void log2Row(const float* depth, float* to, std::size_t width) { HWY_DYNAMIC_DISPATCH(log2All)(depth, to, width); }

void shadeRow(const EdlRows& rows, std::size_t begin, std::size_t end, float gain, std::uint32_t* colours) {
  HWY_DYNAMIC_DISPATCH(shade)(rows, begin, end, gain, colours);
}

}  // namespace strata
#endif
