#pragma once
#include <cstdint>
#include <memory>

#include "render/progressive/point_pool.h"
#include "render/rasterizer.h"

namespace strata {

/// How much work a frame may do, and how large the pool is.
struct ProgressiveOptions {
  std::uint64_t pointsPerFrame = 1'000'000;  ///< places of the pool drawn besides the reprojected points; Rumpler's n
  std::uint64_t uploadPerFrame = 500'000;    ///< points that may be put into the pool
  std::uint64_t poolPoints = 12'000'000;     ///< size of the pool, if the driver has room for it
  std::uint32_t key = 1;                     ///< selects the shuffle
};

/// What the last frame did, for panels and measurements.
struct ProgressiveStats {
  std::uint64_t poolPoints = 0, poolFree = 0;  ///< all places of the pool, and the free ones
  std::uint64_t gpuBytes = 0;                  ///< GPU memory of the pool and the pixels
  std::uint32_t pieces = 0, ghostPieces = 0;   ///< pieces in the pool, and freed ones that still have points there
  std::uint64_t shownPoints = 0;               ///< points that the view shows of its list
  std::uint32_t leastImportance = 0, mostImportance = 0;
  std::uint64_t reprojected = 0;  ///< pixels of the last frame that had a point
  std::uint64_t filled = 0;       ///< places visited
  std::uint64_t written = 0;      ///< points put into the pool
  std::uint64_t turnPlaces = 0;   ///< places of a whole turn
  /// Times by OpenGL's clock, or by the wall clock where OpenGL runs on the CPU: emptying the pixels, drawing the
  /// depths of the kept points, those of the places visited, the ids of both, and keeping what the pixels show.
  double clearMs = 0.0, reprojectMs = 0.0, fillMs = 0.0, indexMs = 0.0, keepMs = 0.0;
  double uploadMs = 0.0, readMs = 0.0, resolveMs = 0.0;  ///< wall time of the render thread
};

/// Draws progressively (Rumpler 2019). Each frame reprojects the points that the last one showed, and adds the next few
/// of a pool that holds the points of all nodes in a shuffled order. The nearest of both wins, and of equals the lower
/// id. So a view at rest gets the picture of every other rasterizer after one turn of the pool at most. It draws one
/// view at a time, shades plainly and knows no overdraw.
class ProgressiveRasterizer : public Rasterizer {
 public:
  /// Sets the options of the next frames. The size of the pool and its key stay as they were.
  virtual void setOptions(const ProgressiveOptions& options) = 0;
  virtual const ProgressiveOptions& options() const = 0;
  virtual const ProgressiveStats& progress() const = 0;
};

/// Makes the rasterizer, which needs OpenGL 4.3. `threads` 0 means one per core. Throws Error where the context has
/// less, or no memory for the pool.
std::unique_ptr<ProgressiveRasterizer> createProgressiveRasterizer(std::unique_ptr<GlContext> context,
                                                                   const ProgressiveOptions& options, int threads = 0);

}  // namespace strata
