#include "render/post_kernel.h"

#include <algorithm>
#include <cmath>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/post_kernel.cpp"  // compiled once for each instruction set
#include <hwy/foreach_target.h>
// After foreach_target.h: these two are for one target at a time.
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

std::uint32_t scaled(std::uint32_t colour, float factor) {
  std::uint32_t result = colour & 0xff000000u;
  for (int shift = 0; shift < 24; shift += 8) {
    const float channel = static_cast<float>(colour >> shift & 255u) * factor;
    result |= static_cast<std::uint32_t>(channel + 0.5f) << shift;
  }
  return result;
}

void shadeOne(const EdlRows& r, std::size_t x, float gain, std::uint32_t* colours) {
  if (std::isinf(r.here[x])) return;
  const std::size_t columns[3] = {x - std::min(x, r.apart), x, std::min(x + r.apart, r.width - 1)};
  float inFront = 0.0f;
  for (const float* row : {r.above, r.here, r.below})
    for (const std::size_t column : columns) inFront += std::max(0.0f, r.here[x] - row[column]);
  if (inFront > 0.0f) colours[x] = scaled(colours[x], std::exp(-inFront * gain));
}

void shade(const EdlRows& r, std::size_t begin, std::size_t end, float gain, std::uint32_t* colours) {
  const hn::ScalableTag<float> tag;
  const hn::RebindToUnsigned<decltype(tag)> word;
  const hn::RebindToSigned<decltype(tag)> integer;
  const std::size_t lanes = hn::Lanes(tag);
  const std::size_t safeEnd = std::min(end, r.width - std::min(r.width, r.apart));
  std::size_t x = begin;
  for (; x < std::min(end, r.apart); ++x) shadeOne(r, x, gain, colours);
  for (; x + lanes <= safeEnd; x += lanes) {
    const auto here = hn::LoadU(tag, r.here + x);
    const auto none = hn::Zero(tag);
    const auto drawn = hn::Lt(here, hn::Set(tag, std::numeric_limits<float>::infinity()));
    if (hn::AllFalse(tag, drawn)) continue;
    const auto ahead = [&](const float* row, std::size_t at) { return hn::Max(none, here - hn::LoadU(tag, row + at)); };
    auto inFront = ahead(r.here, x - r.apart) + ahead(r.here, x + r.apart);
    for (const float* row : {r.above, r.below})
      inFront = inFront + ahead(row, x - r.apart) + ahead(row, x) + ahead(row, x + r.apart);
    const auto factor = hn::Exp(tag, hn::Max(hn::Set(tag, -87.0f), none - inFront * hn::Set(tag, gain)));
    const auto colour = hn::LoadU(word, colours + x);
    auto result = hn::And(colour, hn::Set(word, 0xff000000u));
    const auto channel = [&](auto shifted) {
      const auto value = hn::ConvertTo(tag, hn::BitCast(integer, hn::And(shifted, hn::Set(word, 255u))));
      return hn::BitCast(word, hn::ConvertTo(integer, value * factor + hn::Set(tag, 0.5f)));
    };
    result = hn::Or(result, channel(colour));
    result = hn::Or(result, hn::ShiftLeft<8>(channel(hn::ShiftRight<8>(colour))));
    result = hn::Or(result, hn::ShiftLeft<16>(channel(hn::ShiftRight<16>(colour))));
    hn::StoreU(hn::IfThenElse(hn::RebindMask(word, drawn), result, colour), word, colours + x);
  }
  for (; x < end; ++x) shadeOne(r, x, gain, colours);
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
