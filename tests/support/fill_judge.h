#pragma once
#include "core/picture.h"
#include "core/render_list.h"
#include "core/view.h"

namespace strata::test {

/// The list with each point kept by chance, its nodes' spacings widened to match. Batches stay whole in number, with
/// fewer points; nodes that lose all are left out.
RenderList thinned(const RenderList& list, double share, std::uint32_t seed);

/// A filled picture of fewer points against the one of all points, by their depths in the pixel and its eight
/// neighbours.
struct FillJudgement {
  double covered = 1.0;  ///< share of the full picture's pixels in which the filled one shows nothing farther away
  double wrong = 0.0;    ///< share of all pixels in which it shows something where the full one is open, or nearer
};
FillJudgement judgeFill(const Picture& full, const Picture& filled);

/// How much the colours of surfaces change from one frame of a moving camera to the next: mean over red, green and blue
/// of |difference|, 0 to 255. Each pixel of `full`, the picture of all points seen by `view`, says where its surface
/// lies; `frame` and `before` are compared in the pixels that show this place in `view` and in `viewBefore`. Places
/// outside of the frame before, and such that something hides there (by `fullBefore`), do not count.
double flicker(const Picture& full, const View& view, const Picture& frame, const Picture& fullBefore,
               const View& viewBefore, const Picture& before);

}  // namespace strata::test
