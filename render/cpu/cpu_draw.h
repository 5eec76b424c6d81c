#pragma once
#include <span>

#include "render/picture/visibility.h"
#include "render/plan/batch_plan.h"
#include "render/thread_pool.h"

namespace strata {

/// One view while it is drawn.
struct CpuTarget {
  DrawPlan plan;
  VisibilityBuffer buffer;
  /// Pixels of their own for all threads but the first, so that none needs a lock. They are empty between draws.
  std::vector<std::vector<PackedPixel>> privatePixels;
};

/// Gives the buffer the size of the plan's view, all pixels empty.
void clearTarget(CpuTarget& target, const ThreadPool& pool);

/// Draws the planned batches into the targets, of which there are at most two. Where both want a point with the same
/// precision, it is read once for both. Fills the sums and counts that `options` ask for. The result does not depend on
/// the number of threads.
void drawBatches(std::span<CpuTarget> targets, const DrawOptions& options, const ThreadPool& pool);

}  // namespace strata
