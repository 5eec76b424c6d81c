#pragma once
#include <cstdint>
#include <vector>

#include "core/image.h"

namespace strata {

/// A finished picture; row 0 is the top. Each vector has width * height entries, row by row.
struct Picture {
  static constexpr std::uint32_t kNoPoint = 0xffffffffu;

  int width = 0;
  int height = 0;
  std::vector<std::uint32_t> colour;   ///< R | G<<8 | B<<16 | 255<<24
  std::vector<float> depth;            ///< metres along the view direction; +inf for pixels without a point
  std::vector<std::uint32_t> pointId;  ///< ids as RenderList counts them; kNoPoint for pixels without a point
};

/// The colours of a picture.
inline Image imageOf(const Picture& picture) { return {picture.width, picture.height, picture.colour}; }

}  // namespace strata
