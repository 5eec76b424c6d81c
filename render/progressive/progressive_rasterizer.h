#pragma once
#include <cstdint>
#include <memory>

#include "render/progressive/point_pool.h"
#include "render/rasterizer.h"

namespace strata {

struct ProgressiveOptions {
  std::uint64_t pointsPerFrame = 1'000'000;  ///< of the pool, drawn beside what is reprojected; Rumpler's n
  std::uint64_t uploadPerFrame = 500'000;    ///< points that may go into the pool
  std::uint64_t poolPoints = 12'000'000;     ///< as many as the driver has room for
  std::uint32_t key = 1;                     ///< of the shuffle
};

/// What the last frame did, for panels and measurements.
struct ProgressiveStats {
  std::uint64_t poolPoints = 0, poolFree = 0;  ///< places, those that nobody has
  std::uint64_t gpuBytes = 0;                  ///< of the pool, the pixels and what goes with them
  std::uint32_t pieces = 0, ghostPieces = 0;   ///< in the pool; freed, and not removed everywhere yet
  std::uint64_t shownPoints = 0;               ///< of the pieces that the frame may show
  std::uint32_t leastImportance = 0, mostImportance = 0;
  std::uint64_t reprojected = 0;  ///< pixels that had a point
  std::uint64_t filled = 0;       ///< places gone over
  std::uint64_t written = 0;      ///< points put into the pool
  std::uint64_t turnPlaces = 0;   ///< that a turn goes over
  /// By OpenGL's clock, on the CPU by its own: emptying the pixels; depths of the kept points, of the range of the
  /// pool; lowest ids of both; keeping.
  double clearMs = 0.0, reprojectMs = 0.0, fillMs = 0.0, indexMs = 0.0, keepMs = 0.0;
  double uploadMs = 0.0, readMs = 0.0, resolveMs = 0.0;  ///< of the render thread
};

/// Progressive drawing (Rumpler 2019): each frame draws the points of the last one again, as this frame sees them, and
/// the next few of a pool with the points of all nodes in a shuffled order. The nearest of both wins, and of equals the
/// lower id, so that a view that stands still has the picture of every other rasterizer after at most one turn of the
/// pool. One view; plain shading; no overdraw.
class ProgressiveRasterizer : public Rasterizer {
 public:
  /// Of the next frames; all but the size of the pool, its shuffle and its key, which stay as they were.
  virtual void setOptions(const ProgressiveOptions& options) = 0;
  virtual const ProgressiveOptions& options() const = 0;
  virtual const ProgressiveStats& progress() const = 0;
};

/// Needs OpenGL 4.3. Throws Error where the context has less or no memory for the pool.
std::unique_ptr<ProgressiveRasterizer> createProgressiveRasterizer(std::unique_ptr<GlContext> context,
                                                                   const ProgressiveOptions& options, int threads = 0);

}  // namespace strata
