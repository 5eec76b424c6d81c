#pragma once
#include <cstdint>
#include <string>

#include "core/draw_options.h"
#include "core/picture.h"
#include "core/render_list.h"

namespace strata::test {

/// The picture that every rasterizer must draw. One after another, each point is placed by pointPosition() at the
/// precision of its batch and projected in double. The smallest float depth wins, then the lower id. Nothing is culled;
/// only what `options` clip, filter by class or leave out by gaze is missing. Only depth and pointId are filled.
Picture oraclePicture(const RenderList& list, const View& view, const DrawOptions& options = {});

/// How a picture differs from the oracle's.
struct Comparison {
  std::uint64_t covered = 0;      ///< pixels where either picture has a point
  std::uint64_t different = 0;    ///< of these: another id
  std::uint64_t unexplained = 0;  ///< of these: neither a depth tie, nor a point on the edge of its pixel
  std::string firstUnexplained;

  double agreement() const {
    return covered == 0 ? 1.0 : 1.0 - static_cast<double>(different) / static_cast<double>(covered);
  }
};

/// Compares `picture` with the oracle's. A difference counts as explained where the two points tie (their depths differ
/// by at most 1e-6 of themselves), or one of them lies within 1e-3 pixels of its pixel's edge, or within 1e-6 of the
/// near plane.
Comparison compareToOracle(const RenderList& list, const View& view, const Picture& picture,
                           const DrawOptions& options = {});

}  // namespace strata::test
