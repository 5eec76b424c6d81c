#pragma once
#include <cstdint>

namespace strata {

/// How compute shaders find the point that a pixel shows. All give the same picture.
enum class ComputeWay : std::uint8_t {
  compute64,   ///< one pass, one 64-bit atomic minimum of depth and id (Schütz 2022, 3.2)
  compute32,   ///< the same on plain OpenGL 4.3: a depth pass, then an index pass, with 32-bit atomic minima
  computeLock  ///< one pass, a lock for each pixel (Günther 2013, Algorithms 2 and 3)
};

}  // namespace strata
