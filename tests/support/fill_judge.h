#pragma once
#include "core/picture.h"
#include "core/render_list.h"
#include "core/view.h"

namespace strata::test {

/// The list with only `share` of its points, chosen at random, and with the spacings of its nodes widened to match.
/// Batches keep their number but have fewer points. Nodes that lose all points are left out.
RenderList thinned(const RenderList& list, double share, std::uint32_t seed);

/// How a filled picture of fewer points compares with the picture of all points. A depth is compared with those of its
/// pixel and the eight around it.
struct FillJudgement {
  double covered = 1.0;  ///< share of the full picture's pixels in which the filled one shows nothing farther away
  double wrong = 0.0;    ///< share of all pixels in which it shows something where the full one is open, or nearer
};
FillJudgement judgeFill(const Picture& full, const Picture& filled);

/// One frame of a moving camera.
struct FilledFrame {
  const View& view;
  const Picture& full;    ///< of all points
  const Picture& filled;  ///< of fewer points, its holes filled
};

/// How much the colours of surfaces change between two successive frames: the mean over red, green and blue of the
/// absolute difference, 0 to 255. Each pixel of now.full tells where a surface lies; the two filled pictures are
/// compared in the pixels that show this place. Places that lie outside of the frame before, or are hidden in it, do
/// not count.
double flicker(const FilledFrame& now, const FilledFrame& before);

}  // namespace strata::test
