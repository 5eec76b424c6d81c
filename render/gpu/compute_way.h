#pragma once
#include <cstdint>

namespace strata {

/// How compute shaders find the point that a pixel shows. All ways draw the same picture.
enum class ComputeWay : std::uint8_t {
  compute64,   ///< in one pass, by a 64-bit atomic minimum of depth and id (Schütz 2022, 3.2)
  compute32,   ///< in two passes, for depths and for ids, by 32-bit atomic minima: OpenGL 4.3 has no others
  computeLock  ///< in one pass, by a lock for each pixel (Günther 2013, Algorithms 2 and 3)
};

}  // namespace strata
