#pragma once
#include <cstdint>
#include <string>

#include "core/draw_options.h"
#include "core/picture.h"
#include "core/render_list.h"

namespace strata::test {

/// The picture every rasterizer must give: every point placed by pointPosition() at its batch's precision and
/// projected in double precision, one after another; smallest float depth wins, then the lower id. No culling, but what
/// `options` clip, filter by class and leave out by gaze. Fills depth and pointId only.
Picture oraclePicture(const RenderList& list, const View& view, const DrawOptions& options = {});

/// How a frame differs from the oracle's.
struct Comparison {
  std::uint64_t covered = 0;      ///< pixels where either picture has a point
  std::uint64_t different = 0;    ///< of these: another id
  std::uint64_t unexplained = 0;  ///< of these: neither a depth tie, nor a point on the edge of its pixel
  std::string firstUnexplained;

  double agreement() const {
    return covered == 0 ? 1.0 : 1.0 - static_cast<double>(different) / static_cast<double>(covered);
  }
};

/// A difference counts as explained where the two points are a tie (depths equal within 1e-6 of themselves), or one of
/// them lies within 1e-3 pixels of its pixel's edge, or within 1e-6 of the near plane.
Comparison compareToOracle(const RenderList& list, const View& view, const Picture& picture,
                           const DrawOptions& options = {});

}  // namespace strata::test
