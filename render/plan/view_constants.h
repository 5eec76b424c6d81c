#pragma once
#include <array>
#include <glm/glm.hpp>

#include "core/view.h"

namespace strata {

/// What is the same for all batches of a frame.
struct ViewConstants {
  View view;
  Projection projection;
  std::array<glm::dvec4, 5> planes;
  glm::dvec4 rowX, rowY;      ///< as Projection's, with the image's centre as origin
  double pixelsPerMetre = 0;  ///< at depth 1 (perspective) or anywhere (orthographic), at the image's centre
  double cornerStretch = 1;   ///< how much larger a length may appear in the image's corner
  bool drawable = false;      ///< false for an empty image or a view that is not finite
};
ViewConstants viewConstants(const View& view);

/// What a kernel needs to turn clip coordinates into pixels.
struct Viewport {
  float halfWidth = 0, halfHeight = 0;  ///< of the whole picture
  float width = 0, height = 0;          ///< of the image
  float left = 0, top = 0;              ///< of the image in the picture; whole pixels
  float nearDepth = 0;
  bool perspective = true;
};
Viewport viewport(const ViewConstants& constants);

}  // namespace strata
