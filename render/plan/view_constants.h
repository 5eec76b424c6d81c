#pragma once
#include <array>
#include <glm/glm.hpp>

#include "core/view.h"

namespace strata {

/// A view with everything derived from it that all batches share.
struct ViewConstants {
  View view;
  Projection projection;
  std::array<glm::dvec4, 5> planes;
  glm::dvec4 rowX, rowY;      ///< those of Projection, with the centre of the whole picture as origin
  double pixelsPerMetre = 0;  ///< in the middle of the picture, at depth 1 (perspective) or at any depth
  double cornerStretch = 1;   ///< how much longer a length may appear in a corner of the picture
  bool drawable = false;      ///< false for an empty image or a view that is not finite
};
ViewConstants viewConstants(const View& view);

/// What a kernel needs to turn projected coordinates into pixels.
struct Viewport {
  float halfWidth = 0, halfHeight = 0;  ///< of the whole picture
  float width = 0, height = 0;          ///< of the image
  float left = 0, top = 0;              ///< of the image in the picture; whole pixels
  float nearDepth = 0;
  bool perspective = true;
};
Viewport viewport(const ViewConstants& constants);

}  // namespace strata
