#include "render/flood/splat_kernel.h"

#include <algorithm>
#include <cmath>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/flood/splat_kernel.cpp"  // compiled once for each instruction set
#include <hwy/foreach_target.h>
// These come behind foreach_target.h, because they are compiled for one target at a time.
#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>
// This one comes last, because it uses the types of highway.h.
#include "render/flood/flood_vectors-inl.h"

HWY_BEFORE_NAMESPACE();
namespace strata {
namespace HWY_NAMESPACE {
namespace {

/// Calls visit(offset in the strip, depth, d^2, mask) for each vector of pixels; the mask says which of them the splat
/// covers.
template <typename Visit>
HWY_INLINE void forEachFragment(const FloodSplat& splat, const FloodStrip& strip, Visit visit) {
  const auto one = hn::Set(kFloat, 1.0f), none = hn::Zero(kFloat);
  const auto set = [](float value) { return hn::Set(kFloat, value); };
  const auto acrossX = set(splat.acrossX), alongX = set(splat.alongX);
  const auto lanes = static_cast<int>(hn::Lanes(kFloat));
  for (int y = std::max(int{splat.top}, strip.top); y <= std::min(int{splat.bottom}, strip.bottom - 1); ++y) {
    const float dy = static_cast<float>(y) + 0.5f - splat.y;
    const auto acrossY = set(splat.acrossY * dy), alongY = set(splat.alongY * dy);
    const std::size_t start = static_cast<std::size_t>(y - strip.top) * strip.stride;
    for (int x = splat.left; x <= splat.right; x += lanes) {
      const auto dx = hn::Iota(kFloat, static_cast<float>(x) + 0.5f - splat.x);
      const auto n = one + set(splat.tiltX) * dx + set(splat.tiltY * dy);
      const auto inverse = one / n;
      const auto a = (acrossX * dx + acrossY) * inverse, b = (alongX * dx + alongY) * inverse;
      auto distance2 = a * a + b * b;
      auto covered = hn::And(hn::FirstN(kFloat, static_cast<std::size_t>(splat.right - x + 1)),
                             hn::And(hn::Le(distance2, one), hn::Gt(n, none)));
      if (splat.openSectors != 0) {
        const auto open = hn::And(hn::Shr(hn::Set(kWord, splat.openSectors), sector(dx, set(dy))), hn::Set(kWord, 1u));
        const auto shorter = toMask(hn::Ne(open, hn::Zero(kWord)));
        distance2 = hn::IfThenElse(shorter, distance2 * set(kFloodOpenSide * kFloodOpenSide), distance2);
        covered = hn::And(covered, hn::Le(distance2, one));
      }
      if (hn::AllFalse(kFloat, covered)) continue;
      const auto depth = (set(splat.centreDepth + splat.slopeY * dy) + set(splat.slopeX) * dx) * inverse;
      visit(start + static_cast<std::size_t>(x), depth, distance2, covered);
    }
  }
}

void drawSplatDepthHere(const FloodSplat& splat, const FloodStrip& strip) {
  forEachFragment(splat, strip, [&](std::size_t i, Floats depth, Floats, Mask covered) {
    const auto limit = depth + hn::Max(depth * hn::Set(kFloat, kFloodDepthShare), hn::Set(kFloat, splat.radius));
    const auto old = hn::LoadU(kFloat, strip.limit + i);
    hn::StoreU(hn::IfThenElse(covered, hn::Min(limit, old), old), kFloat, strip.limit + i);
  });
}

void blendSplatHere(const FloodSplat& splat, std::uint32_t colour, const FloodStrip& strip) {
  const auto part = [colour](int shift) { return hn::Set(kFloat, static_cast<float>(colour >> shift & 255u)); };
  const auto red = part(0), green = part(8), blue = part(16);
  forEachFragment(splat, strip, [&](std::size_t i, Floats depth, Floats distance2, Mask covered) {
    const auto counts = hn::And(covered, hn::Le(depth, hn::LoadU(kFloat, strip.limit + i)));
    if (hn::AllFalse(kFloat, counts)) return;
    const auto weight = hn::IfThenElseZero(counts, hn::Exp(kFloat, hn::Neg(distance2)));
    const auto add = [i](Floats value, float* to) { hn::StoreU(hn::LoadU(kFloat, to + i) + value, kFloat, to + i); };
    add(weight * red, strip.red);
    add(weight * green, strip.green);
    add(weight * blue, strip.blue);
    add(hn::IfThenElseZero(counts, weight * depth), strip.depth);
    add(weight, strip.weight);
    const auto old = hn::LoadU(kFloat, strip.heaviest + i);
    const auto heavier = hn::Gt(weight, old);
    if (hn::AllFalse(kFloat, heavier)) return;
    hn::StoreU(hn::IfThenElse(heavier, weight, old), kFloat, strip.heaviest + i);
    hn::StoreU(hn::IfThenElse(toWord(heavier), hn::Set(kWord, splat.from), hn::LoadU(kWord, strip.from + i)), kWord,
               strip.from + i);
  });
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace strata
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace strata {

HWY_EXPORT(drawSplatDepthHere);
HWY_EXPORT(blendSplatHere);

void drawSplatDepth(const FloodSplat& splat, const FloodStrip& strip) {
  HWY_DYNAMIC_DISPATCH(drawSplatDepthHere)(splat, strip);
}

void blendSplat(const FloodSplat& splat, std::uint32_t colour, const FloodStrip& strip) {
  HWY_DYNAMIC_DISPATCH(blendSplatHere)(splat, colour, strip);
}

}  // namespace strata
#endif
