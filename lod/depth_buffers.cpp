#include "lod/depth_buffers.h"

#include <utility>

namespace strata {

const CoarseDepth& DepthBuffers::publish() {
  const MutexLock lock(mutex_);
  std::swap(front_, back_);
  return *front_;
}

bool DepthBuffers::hides(const View& view, const Contour& contour, double reach) const {
  const MutexLock lock(mutex_);
  return front_->view() == view && front_->hides(contour, reach);
}

void DepthBuffers::copy(std::vector<float>& depths) const {
  depths.clear();
  const MutexLock lock(mutex_);
  for (int row = 0; row < CoarseDepth::kSide; ++row)
    for (int column = 0; column < CoarseDepth::kSide; ++column)
      depths.push_back(static_cast<float>(front_->depth(column, row)));
}

}  // namespace strata
