#pragma once
#include <cstdint>
#include <vector>

namespace strata {

/// A finished picture. Row 0 is the top.
struct Picture {
  static constexpr std::uint32_t kNoPoint = 0xffffffffu;

  int width = 0;
  int height = 0;
  std::vector<std::uint32_t> colour;   ///< R | G<<8 | B<<16 | 255<<24
  std::vector<float> depth;            ///< metres along the view direction; +inf where nothing was drawn
  std::vector<std::uint32_t> pointId;  ///< see RenderList; kNoPoint where nothing was drawn
};

}  // namespace strata
