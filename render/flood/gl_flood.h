#pragma once
#include <memory>
#include <string>

#include "render/flood/flood_fill.h"
#include "render/gl/gl_functions.h"

namespace strata {

/// What the shaders of hole filling are compiled with; `groupSize`: threads of a work-group.
std::string floodDefines(std::uint32_t groupSize);

/// floodFill() in compute shaders of OpenGL 4.3: the same four steps on the GPU, for the rasterizers that draw there.
/// Frames are those of floodFill() but for what other rounding decides: at most 1 pixel in 200 differs by more than 2
/// of 255. Sums are of integers, so a frame does not depend on the order of threads.
/// The context is current whenever it is used or destroyed; it is made with the first frame that wants it.
class GlFlood {
 public:
  GlFlood(const GlFunctions& functions, std::uint32_t groupSize);
  ~GlFlood();
  GlFlood(const GlFlood&) = delete;
  GlFlood& operator=(const GlFlood&) = delete;

  /// As floodFill(); the steps' times are the GPU's, by its own clock; sending and fetching the picture is not in them.
  /// What the driver cannot do, a picture larger than its storage blocks say, is filled by floodFill().
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
