#pragma once
#include <memory>
#include <vector>

#include "core/mutex.h"
#include "lod/coarse_depth.h"

namespace strata {

/// Two coarse depth buffers: the LOD thread fills one while the loaders test against the other (Kanzok 2015, 3.2.1,
/// item 4).
class DepthBuffers {
 public:
  /// LOD thread: the buffer to fill.
  CoarseDepth& back() { return *back_; }
  /// LOD thread: the loaders now test against the buffer that was filled. It does not change until the next publish().
  const CoarseDepth& publish();

  /// Any thread. True when the published buffer is of this view and hides the contour, grown by `reach` metres.
  bool hides(const View& view, const Contour& contour, double reach) const;
  /// Any thread; for pictures. Replaces `depths` by those published last in metres, CoarseDepth::kSide squared, row by
  /// row; infinite where nothing is hidden.
  void copy(std::vector<float>& depths) const;

 private:
  mutable Mutex mutex_;
  std::unique_ptr<CoarseDepth> front_ STRATA_GUARDED_BY(mutex_) = std::make_unique<CoarseDepth>();

  // Used by the LOD thread.
  std::unique_ptr<CoarseDepth> back_ = std::make_unique<CoarseDepth>();
};

}  // namespace strata
