#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "core/draw_options.h"
#include "core/picture.h"
#include "core/render_list.h"

namespace strata {

/// What one draw did and what it cost.
struct DrawStats {
  std::uint64_t pointsDrawn = 0;  ///< sent through projection, after culling
  std::uint32_t batchesDrawn = 0;
  std::uint32_t batchesCulled = 0;         ///< outside the frustum
  std::uint32_t batchesAt[3] = {0, 0, 0};  ///< by precision: 10, 20, 30 bits
  std::uint32_t nodesNotUploaded = 0;      ///< left out of this frame: over the upload budget or out of GPU memory
  std::uint64_t bytesUploaded = 0;
  std::uint64_t gpuBytes = 0;       ///< held by node data on the GPU; 0 for cpu
  std::uint64_t lockRetries = 0;    ///< compute_lock: turns of its loops beyond the first
  std::uint32_t lockRepairs = 0;    ///< compute_lock: pictures that compute32's passes had to finish
  std::uint64_t pointsPending = 0;  ///< progressive: places of the pool that this picture has not met yet
  double uploadMs = 0.0, drawMs = 0.0, resolveMs = 0.0;
  double gpuMs = 0.0;  ///< of drawMs, by OpenGL's own clock: clearing, culling, drawing; no reading back. 0 for cpu
};

/// Whether drawing the same once more would change nothing.
inline bool isFinished(const DrawStats& stats) {
  return stats.pointsPending == 0 && (stats.nodesNotUploaded == 0 || stats.bytesUploaded == 0);
}

/// Adds what one draw did to the sum of several.
void addStats(const DrawStats& one, DrawStats& sum);

/// Turns a RenderList into pixels. One thread uses it: the render thread, which owns the GL context if there is one.
/// All implementations give the picture of the oracle (tests/support/oracle.h): for each pixel the point with the
/// smallest depth wins, compared as 32-bit float; equal floats go to the lower id. Points of one store that are placed
/// at one position have equal floats, always (batch_plan.h), so which of them is seen depends on their ids alone.
/// Drawing does not throw.
class Rasterizer {
 public:
  virtual ~Rasterizer() = default;
  /// Draws `list` as seen by `view` (which may be newer than the list's). `picture` is resized to the view.
  virtual DrawStats draw(const RenderList& list, const View& view, const DrawOptions& options, Picture& picture) = 0;
  /// One picture of `list` for each view, frames[i] as draw() gives for views[i]; as many frames as views. The sum of
  /// the stats. This one draws them one after the other; an implementation may read each point once for all views
  /// (Schütz 2022, 3.6).
  virtual DrawStats drawViews(const RenderList& list, std::span<const View> views, const DrawOptions& options,
                              std::span<Picture> pictures);
  virtual std::string_view name() const = 0;
  /// "llvmpipe (LLVM 15.0.6, 256 bits)", "2 threads"; for reports.
  virtual std::string device() const = 0;
};

}  // namespace strata
