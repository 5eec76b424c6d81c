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
// A point's cell X (10, 20 or 30 bits an axis, NodeData) is an integer, and so is the cell E that holds the eye,
// clamped to one box beside the batch. Their difference is exact, so what is left is small where the eye is near:
//
//   d = (X - E) * cell + rest                      camera-relative metres; E and rest are made in double per batch
//   x     = step.x*(X-E).x + step.y*(X-E).y + step.z*(X-E).z + base      float, rowX * cell and rowX . rest folded in
//   y, depth likewise;  w = depth (perspective) or 1 (orthographic)
//   pixel = (floor(x / w + width/2), floor(y / w + height/2))
//
// drawn where near <= depth and the pixel is in the image. Each term is at most |row| * |d| and rounded to 24 bits:
// a few 1e-4 pixels at 1920 columns, whatever the coordinates, and whether the eye is inside the batch or not.
// The smallest depth wins a pixel, compared as float bits; the lower id wins a tie.

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
  float halfWidth = 0, halfHeight = 0;
  float width = 0, height = 0;
  float nearDepth = 0;
  bool perspective = true;
};
Viewport viewport(const ViewConstants& constants);

/// Upper bound of the pixels that the longest side of the batch's box covers. The box is the one of 2^bits grid
/// steps, because its 1024th part is what a 10-bit coordinate resolves.
double projectedSizePx(const ViewConstants& constants, const NodeData& node, const Batch& batch);

/// Schütz 2022, 3.3: 10 bits below 500 pixels, 20 below 500 * 1024, else 30; half a cell is then less than a quarter
/// of a pixel. Never more planes than the node has, nor than the batch's bits fill.
Precision batchPrecision(const ViewConstants& constants, const NodeData& node, const Batch& batch);

/// Rows of the float transform: xyz is the step a cell, w the base.
struct BatchTransform {
  glm::vec4 x, y, depth;
  glm::ivec3 eyeCell;
};
BatchTransform batchTransform(const ViewConstants& constants, const NodeData& node, const Batch& batch,
                              Precision precision);

/// One batch that survived culling, cut to the prefix that its item asks for.
struct PlannedBatch {
  const NodeData* node = nullptr;
  std::uint32_t item = 0;        ///< index into RenderList::items
  std::uint32_t firstPoint = 0;  ///< within the node
  std::uint32_t pointCount = 0;
  std::uint32_t firstId = 0;
  Precision precision = Precision::low10;
  BatchTransform transform;
};

struct DrawPlan {
  ViewConstants constants;
  std::vector<PlannedBatch> batches;  ///< in list order
  std::uint64_t pointCount = 0;
  std::uint32_t batchesCulled = 0;
  std::uint32_t batchesAt[3] = {0, 0, 0};  ///< by precision
};
/// Culls, cuts and chooses precisions. The plan points into the list's nodes.
void planBatches(const RenderList& list, const View& view, DrawPlan& plan);
/// The counts of a plan that is drawn whole.
DrawStats planStats(const DrawPlan& plan);

}  // namespace strata
