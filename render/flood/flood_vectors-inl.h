// Included once for each instruction set, behind hwy/highway.h: the guard is Highway's for such files.
#if defined(STRATA_FLOOD_VECTORS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef STRATA_FLOOD_VECTORS_INL_H
#undef STRATA_FLOOD_VECTORS_INL_H
#else
#define STRATA_FLOOD_VECTORS_INL_H
#endif

#include "render/flood/flood_vectors.h"

HWY_BEFORE_NAMESPACE();
namespace strata {
namespace HWY_NAMESPACE {
namespace {
namespace hn = hwy::HWY_NAMESPACE;

using Float = hn::CappedTag<float, kFloodTile>;
using Word = hn::RebindToUnsigned<Float>;
using Integer = hn::RebindToSigned<Float>;
using Floats = hn::Vec<Float>;
using Words = hn::Vec<Word>;
using Mask = hn::Mask<Float>;

constexpr Float kFloat{};
constexpr Word kWord{};
constexpr Integer kInteger{};

HWY_INLINE Floats toFloat(Words value) { return hn::ConvertTo(kFloat, hn::BitCast(kInteger, value)); }
HWY_INLINE Mask toMask(hn::Mask<Word> mask) { return hn::RebindMask(kFloat, mask); }
HWY_INLINE hn::Mask<Word> toWord(Mask mask) { return hn::RebindMask(kWord, mask); }
HWY_INLINE Words column(Words pixel) { return hn::And(pixel, hn::Set(kWord, 0xffffu)); }
HWY_INLINE Words row(Words pixel) { return hn::ShiftRight<16>(pixel); }

/// floodSector() of pixels that lie (dx, dy) away.
HWY_INLINE Words sector(Floats dx, Floats dy) {
  const auto bit = [](Mask mask, std::uint32_t value) {
    return hn::IfThenElseZero(toWord(mask), hn::Set(kWord, value));
  };
  const auto none = hn::Zero(kFloat);
  return hn::Or(bit(hn::Lt(dy, none), 4), hn::Or(bit(hn::Lt(dx, none), 2), bit(hn::Lt(hn::Abs(dx), hn::Abs(dy)), 1)));
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace strata
HWY_AFTER_NAMESPACE();
#endif
