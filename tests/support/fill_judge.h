#pragma once
#include "core/frame.h"
#include "core/render_list.h"

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
FillJudgement judgeFill(const Frame& full, const Frame& filled);

}  // namespace strata::test
