#pragma once
#include <cstdint>
#include <vector>

#include <glm/glm.hpp>
#include <glm/gtc/type_precision.hpp>

namespace strata {

enum class ColourMode : std::uint8_t { rgb, intensity, elevation, classification, level };

/// How points become colours; the same for every rasterizer.
struct DrawOptions {
  ColourMode colour = ColourMode::rgb;
  glm::vec2 intensityRange{0.0f, 65535.0f};  ///< black to white
  glm::dvec2 elevationRange{0.0, 1.0};       ///< world z at the ends of the colour map
  glm::u8vec3 background{24, 26, 30};
  int pointSize = 1;         ///< least side of the square of pixels a point covers, 1 to kLargestPoint
  float pointMetres = 0.0f;  ///< side of that square in metres, where it is more pixels than pointSize
  bool edl = false;          ///< eye-dome lighting over the finished picture
  float edlStrength = 1.0f;

  static constexpr int kLargestPoint = 32;  ///< pixels
};

/// A finished picture. Row 0 is the top.
struct Frame {
  static constexpr std::uint32_t kNoPoint = 0xffffffffu;

  int width = 0;
  int height = 0;
  std::vector<std::uint32_t> colour;   ///< R | G<<8 | B<<16 | 255<<24
  std::vector<float> depth;            ///< metres along the view direction; +inf where nothing was drawn
  std::vector<std::uint32_t> pointId;  ///< see RenderList; kNoPoint where nothing was drawn
};

}  // namespace strata
