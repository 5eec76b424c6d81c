#pragma once
#include <memory>
#include <string>

#include "render/flood/flood_fill.h"
#include "render/gl/gl_functions.h"

namespace strata {

/// The #define lines that the shaders of hole filling are compiled with, for work-groups of `groupSize` threads.
std::string floodDefines(std::uint32_t groupSize);

/// floodFill() in compute shaders of OpenGL 4.3, for the rasterizers that draw on the GPU. It takes the same four
/// steps. Pictures equal those of floodFill() except where rounding decides: at most 1 pixel in 200 differs by more
/// than 2 of 255. All sums are of integers, so a picture does not depend on the order of threads. The context must be
/// current whenever this is used or destroyed. Shaders are compiled for the first picture.
class GlFlood {
 public:
  GlFlood(const GlFunctions& functions, std::uint32_t groupSize);
  ~GlFlood();
  GlFlood(const GlFlood&) = delete;
  GlFlood& operator=(const GlFlood&) = delete;

  /// Does what floodFill() does. The times of the steps are those of the GPU's clock and leave out sending and fetching
  /// the picture. floodFill() takes over where the driver cannot compile the shaders, or its storage blocks are too
  /// small for the picture.
  FloodStats fill(const RenderList& list, const View& view, const FloodSettings& settings, const ThreadPool& pool,
                  Picture& picture);

 private:
  class Work;

  const GlFunctions& gl_;
  const std::uint32_t groupSize_;
  std::unique_ptr<Work> work_;
  bool failed_ = false;
};

}  // namespace strata
