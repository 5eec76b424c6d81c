#pragma once
#include <bitset>
#include <cstdint>
#include <glm/glm.hpp>
#include <glm/gtc/type_precision.hpp>
#include <optional>
#include <vector>

#include "core/box.h"

namespace strata {

enum class ColourMode : std::uint8_t {
  rgb,
  intensity,
  elevation,
  classification,
  level,
  returnNumber,
  normal,     ///< x, y, z from -1 to 1 as red, green, blue
  precision,  ///< how many of the coordinates' bits were read: 10 green, 20 yellow, 30 red
  overdraw    ///< how many points fell on the pixel, by the logarithm (Günther 2013, Fig. 5); points are one pixel
};

enum class Shading : std::uint8_t {
  plain,       ///< a pixel shows its front point
  highQuality  ///< ... the mean colour of its points at most kBlendDepth behind that (Schütz, Kerbl, Wimmer 2021)
};

/// What of the scan is drawn, in world coordinates; everything where all are empty. At most kMost planes, and as many
/// boxes and cutouts together; what is beyond that is not looked at.
struct Clip {
  static constexpr std::size_t kMost = 4;

  std::vector<Box> boxes;          ///< where there are any, only points in one of them
  std::vector<Box> cutouts;        ///< only points in none of these
  std::vector<glm::dvec4> planes;  ///< only points with dot(xyz, p) + w >= 0, for all of them

  bool empty() const { return boxes.empty() && cutouts.empty() && planes.empty(); }
};

/// Fewer nodes where nobody looks (Schütz 2022, 3.6): a node is left out whose box is seen smaller than a threshold,
/// which grows with the distance of the box's centre from the gaze: at less than a third of the picture's height from
/// it `centrePx`, at less than two thirds half-way between, else `peripheryPx`.
struct Gaze {
  bool on = false;
  glm::vec2 at{0.5f, 0.5f};  ///< in widths and heights of the picture
  float centrePx = 100.0f;
  float peripheryPx = 300.0f;
};

/// Which points become pixels and how those become colours; the same for every rasterizer.
struct DrawOptions {
  static constexpr int kLargestPoint = 32;  ///< pixels
  static constexpr int kLargestFill = 7;
  static constexpr float kBlendDepth = 1.01f;  ///< times the front depth

  ColourMode colour = ColourMode::rgb;
  Shading shading = Shading::plain;
  glm::vec2 intensityRange{0.0f, 65535.0f};  ///< black to white
  glm::dvec2 elevationRange{0.0, 1.0};       ///< world z at the ends of the colour map
  glm::u8vec3 background{24, 26, 30};
  std::optional<glm::u8vec3> backgroundBelow;  ///< of the lowest row; `background` is then that of the top one
  int pointSize = 1;         ///< least side of the square of pixels a point covers, 1 to kLargestPoint
  float pointMetres = 0.0f;  ///< side of that square in metres, where it is more pixels than pointSize
  int fill = 1;              ///< 3, 5 or 7: side of the window out of which holes are filled, see fillHoles(); 1: none
  bool jumpFlood = false;    ///< holes are filled with splats as large as points lie apart, then points get their size
  bool edl = false;          ///< eye-dome lighting over the finished picture
  float edlStrength = 1.0f;
  Clip clip;
  std::bitset<256> classes = std::bitset<256>().set();  ///< those drawn; nodes without classes are drawn whole
  Gaze gaze;
};

}  // namespace strata
