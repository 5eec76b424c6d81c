#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "core/draw_options.h"
#include "core/picture.h"
#include "core/render_list.h"

namespace strata {

/// What one draw did, and what it cost.
struct DrawStats {
  std::uint64_t pointsDrawn = 0;  ///< points that were projected, after culling
  std::uint32_t batchesDrawn = 0;
  std::uint32_t batchesCulled = 0;         ///< outside the frustum
  std::uint32_t batchesAt[3] = {0, 0, 0};  ///< by precision: 10, 20, 30 bits
  std::uint32_t nodesNotUploaded = 0;      ///< left out: over the upload budget, or out of GPU memory
  std::uint64_t bytesUploaded = 0;
  std::uint64_t gpuBytes = 0;       ///< GPU memory that node data takes; 0 for cpu
  std::uint64_t lockRetries = 0;    ///< compute_lock: how often its loops ran beyond their first round
  std::uint32_t lockRepairs = 0;    ///< compute_lock: pictures that the passes of compute32 had to finish
  std::uint64_t pointsPending = 0;  ///< progressive: places of the pool that this picture has not seen yet
  double uploadMs = 0.0, drawMs = 0.0, resolveMs = 0.0;
  double gpuMs = 0.0;  ///< clearing, culling and drawing by OpenGL's clock, without reading back; 0 for cpu
};

/// True when drawing the same list again would not change the picture.
inline bool isFinished(const DrawStats& stats) {
  return stats.pointsPending == 0 && (stats.nodesNotUploaded == 0 || stats.bytesUploaded == 0);
}

/// Adds the stats of one draw to those of several.
void addStats(const DrawStats& one, DrawStats& sum);

/// Turns a RenderList into a picture. Only the render thread uses it, which also owns the GL context if there is one.
/// All implementations draw the picture of the oracle (tests/support/oracle.h): the point with the smallest depth wins
/// its pixel. Depths are compared as 32-bit floats, and the lower id wins between equal ones. Points of one store at
/// the same position always have equal floats (plan/grid_transform.h), so their ids alone decide which of them is seen.
/// Drawing does not throw.
class Rasterizer {
 public:
  virtual ~Rasterizer() = default;
  /// Draws `list` as seen by `view`, which may be newer than the view that the list was made for. `picture` is resized
  /// to the view.
  virtual DrawStats draw(const RenderList& list, const View& view, const DrawOptions& options, Picture& picture) = 0;
  /// Draws one picture of `list` for each view: pictures[i] is what draw() gives for views[i]. Returns the sum of the
  /// stats. By default the views are drawn one after the other; an implementation may read each point once for all of
  /// them (Schütz 2022, 3.6).
  virtual DrawStats drawViews(const RenderList& list, std::span<const View> views, const DrawOptions& options,
                              std::span<Picture> pictures);
  virtual std::string_view name() const = 0;
  /// What draws, for reports: "llvmpipe (LLVM 15.0.6, 256 bits)", "2 threads, AVX2".
  virtual std::string device() const = 0;
};

}  // namespace strata
