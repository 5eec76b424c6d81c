#pragma once
#include <memory>
#include <mutex>
#include <vector>

#include "lod/coarse_depth.h"

namespace strata {

/// Two coarse depth buffers: the LOD thread fills one while loaders look into the other (Kanzok 2015, 3.2.1, item 4).
class DepthBuffers {
 public:
  /// LOD thread: the buffer to fill.
  CoarseDepth& back() { return *back_; }
  /// LOD thread: what was filled is now everybody's; it stays as it is until the next publish().
  const CoarseDepth& publish();

  /// Any thread. True when the newest buffer is of this view and hides the contour in it.
  bool hides(const View& view, const Contour& contour, double reach) const;
  /// Any thread; for pictures of it. The newest depths, CoarseDepth::kSide squared, row by row; infinite where nothing
  /// is hidden.
  void copy(std::vector<float>& depths) const;

 private:
  // Used by the LOD thread.
  std::unique_ptr<CoarseDepth> back_ = std::make_unique<CoarseDepth>();

  // Guarded by mutex_.
  mutable std::mutex mutex_;
  std::unique_ptr<CoarseDepth> front_ = std::make_unique<CoarseDepth>();
};

}  // namespace strata
