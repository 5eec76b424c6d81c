#pragma once
#include <span>

#include "render/picture/visibility.h"
#include "render/plan/batch_plan.h"
#include "render/thread_pool.h"

namespace strata {

/// One view of a frame while it is drawn.
struct CpuTarget {
  DrawPlan plan;
  VisibilityBuffer buffer;
  /// For threads but the first: pixels of their own, so that none needs a lock; empty between frames.
  std::vector<std::vector<PackedPixel>> privatePixels;
};

/// Makes the buffer as large as the view and empty.
void clearTarget(CpuTarget& target, const ThreadPool& pool);

/// Draws the planned batches into every target, at most two: each point is read once for both where both want it with
/// the same precision. Fills the sums and counts that `options` ask for. The result does not depend on the number of
/// threads.
void drawBatches(std::span<CpuTarget> targets, const DrawOptions& options, const ThreadPool& pool);

}  // namespace strata
