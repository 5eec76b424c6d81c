#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "core/render_list.h"
#include "core/view.h"
#include "render/rasterizer.h"

namespace strata {

// The arithmetic of every rasterizer
// ----------------------------------
// A store keeps positions as integers of its grid, and a point drawn with 10, 20 or 30 bits stands on that grid too
// (NodeData: in the middle of its cell, whose sides are powers of two of the grid's step). So
//
//   D = (X << shift) + offset      grid steps from E, the grid point next to the eye: an integer of 32 bits an axis
//   d = float(D)                   rounded once, to nearest even; exact where |D| <= 2^24
//   x     = step.x*d.x + (step.y*d.y + (step.z*d.z + base))      three fused multiply-adds; y, depth likewise
//   w     = depth (perspective) or 1 (orthographic)
//   pixel = (floor(x / w + width/2), floor(y / w + height/2))
//
// drawn where near <= depth and the pixel is in the image. `offset` and `shift` (to the right where negative: the bits
// lost are 0) are the batch's; the rows x, y, depth are the same for all batches of a store, made in double once a
// frame. Hence the tie rule: points of one store that are placed at one position have the same D, so the same pixel and
// the same depth to the last bit, whichever node, batch and precision they come from, and the lower id wins.
// Each term is at most |row| * |d| and rounded to 24 bits: a few 1e-4 pixels at 1920 columns, whatever the coordinates,
// and whether the eye is inside the batch or not.
//
// A batch that does not fit 32 bits of steps (at 1 mm, farther than 2100 km) has rows of its own, with its own cells
// for steps and E clamped to one box beside it. Its ties with other batches are settled by rounding.

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

/// False for a node that DrawOptions::gaze leaves out.
bool gazeKeeps(const ViewConstants& constants, const Gaze& gaze, const NodeData& node);

/// Upper bound of the pixels that the longest side of the batch's box covers. The box is the one of 2^bits grid
/// steps, because its 1024th part is what a 10-bit coordinate resolves.
double projectedSizePx(const ViewConstants& constants, const NodeData& node, const Batch& batch);

inline constexpr double kPixelsAt10Bits = 500.0;
inline constexpr double kPixelsAt20Bits = 500.0 * 1024.0;
/// Schütz 2022, 3.3: 10 bits below 500 pixels, 20 below 500 * 1024, else 30; half a cell is then less than a quarter
/// of a pixel. Never more planes than the node has, nor than the batch's bits fill.
Precision batchPrecision(const ViewConstants& constants, const NodeData& node, const Batch& batch);

/// Clip box in grid steps from the eye's cell: a point is inside where lo <= d <= hi.
struct ClipSteps {
  glm::vec3 lo, hi;
};

/// One grid as a frame sees it: xyz of a row is the step along each axis, w the base.
struct GridTransform {
  glm::vec4 x, y, depth;
  std::vector<ClipSteps> clipBoxes, clipCutouts;
  std::vector<glm::vec4> clipPlanes;  ///< rows; inside where the value is >= 0
};

/// How a batch's coordinates become steps of its grid: D = (X << shift) + offset, or X >> -shift.
struct GridPlace {
  std::uint32_t grid = 0;  ///< index into DrawPlan::grids
  glm::ivec3 offset{0};
  glm::ivec3 shift{0};
};

/// One batch that survived culling, cut to the prefix that its item asks for.
struct PlannedBatch {
  const NodeData* node = nullptr;
  std::uint32_t item = 0;        ///< index into RenderList::items
  std::uint32_t firstPoint = 0;  ///< within the node
  std::uint32_t pointCount = 0;
  std::uint32_t firstId = 0;
  Precision precision = Precision::low10;
  bool clipped = false;  ///< part of it may be outside DrawOptions::clip: its points are to be tested
  bool inside = false;   ///< every point is in the image, whatever rounding does: nothing to be tested
  GridPlace place;
};

struct DrawPlan {
  ViewConstants constants;
  std::vector<GridTransform> grids;
  std::vector<PlannedBatch> batches;  ///< in list order
  std::uint64_t pointCount = 0;
  std::uint32_t batchesCulled = 0;         ///< outside the frustum or the clip region, or below the gaze's threshold
  std::uint32_t batchesAt[3] = {0, 0, 0};  ///< by precision
};
/// Culls, cuts and chooses precisions. The plan points into the list's nodes.
void planBatches(const RenderList& list, const View& view, const DrawOptions& options, DrawPlan& plan);
/// The counts of a plan that is drawn whole.
DrawStats planStats(const DrawPlan& plan);

}  // namespace strata
