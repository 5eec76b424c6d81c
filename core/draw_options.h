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
  precision,  ///< bits used of a coordinate: 10 green, 20 yellow, 30 red
  overdraw    ///< logarithm of how many points fell on the pixel (Günther 2013, Fig. 5); points cover one pixel
};

enum class Shading : std::uint8_t {
  plain,       ///< a pixel shows its front point
  highQuality  ///< a pixel shows the mean of its points within kBlendDepth (Schütz, Kerbl, Wimmer 2021)
};

/// The part of the scan that is drawn, in world coordinates; all of it when the three lists are empty. At most kMost
/// planes count, and at most kMost boxes and cutouts together; any more are ignored.
struct Clip {
  static constexpr std::size_t kMost = 4;

  std::vector<Box> boxes;          ///< if there are any, only points in one of them are drawn
  std::vector<Box> cutouts;        ///< points in any of these are not drawn
  std::vector<glm::dvec4> planes;  ///< points with dot(xyz, p) + w < 0 for any of these are not drawn

  bool empty() const { return boxes.empty() && cutouts.empty() && planes.empty(); }
  bool operator==(const Clip&) const = default;
};

/// Draws fewer nodes where nobody looks (Schütz 2022, 3.6). A node is left out when its box appears smaller than a
/// threshold that grows with the distance of the box's centre from the gaze: `centrePx` within a third of the picture's
/// height, half-way between the two within two thirds, `peripheryPx` beyond.
struct Gaze {
  bool on = false;
  glm::vec2 at{0.5f, 0.5f};  ///< in widths and heights of the picture
  float centrePx = 100.0f;
  float peripheryPx = 300.0f;
};

/// Which points are drawn and how pixels get their colours; the same for every rasterizer.
struct DrawOptions {
  static constexpr int kLargestPoint = 32;  ///< pixels
  static constexpr int kLargestFill = 7;
  static constexpr float kBlendDepth = 1.01f;  ///< times the front depth

  ColourMode colour = ColourMode::rgb;
  Shading shading = Shading::plain;
  glm::vec2 intensityRange{0.0f, 65535.0f};  ///< black to white
  glm::dvec2 elevationRange{0.0, 1.0};       ///< world z at the ends of the colour map
  glm::u8vec3 background{24, 26, 30};
  std::optional<glm::u8vec3> backgroundBelow;  ///< colour of the lowest row, if `background` is only the top row's
  int pointSize = 1;         ///< pixels; least side of the square that a point covers, 1 to kLargestPoint
  float pointMetres = 0.0f;  ///< side of that square in metres, where that is more than pointSize
  int fill = 1;              ///< 3, 5 or 7: side of the window from which fillHoles() takes colours; 1: no filling
  bool jumpFlood = false;    ///< floodFill() fills the holes with splats as large as the spacing of the points
  bool edl = false;          ///< eye-dome lighting over the finished picture
  float edlStrength = 1.0f;
  Clip clip;
  std::bitset<256> classes = std::bitset<256>().set();  ///< classes drawn; nodes without classes are drawn whole
  Gaze gaze;
};

/// The part of a drawing that decides which nodes and planes of a store are read.
struct Shown {
  /// The colour mode whose plane is read. Empty: colour, intensity and classification are read.
  std::optional<ColourMode> colour;
  bool normals = false;  ///< normals too, if the store has them
  Clip clip;             ///< nodes that it leaves nothing of are not read

  bool operator==(const Shown&) const = default;
};

/// The one place where a drawing becomes a Shown.
Shown shownBy(const DrawOptions& draw);

}  // namespace strata
