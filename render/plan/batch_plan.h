#pragma once
#include <cstdint>
#include <vector>

#include "core/render_list.h"
#include "core/view.h"
#include "render/plan/grid_transform.h"
#include "render/plan/view_constants.h"
#include "render/rasterizer.h"

namespace strata {

/// False for a node that DrawOptions::gaze leaves out, because it is seen too small for its distance from the gaze.
bool gazeKeeps(const ViewConstants& constants, const Gaze& gaze, const NodeData& node);

/// An upper bound on the pixels that the longest side of the batch's box covers. The box has sides of 2^bits grid
/// steps, and a 10-bit coordinate resolves a 1024th of a side.
double projectedSizePx(const ViewConstants& constants, const NodeData& node, const Batch& batch);

/// The precision that a batch is drawn with: 10 bits below 500 pixels, 20 below 500 * 1024, else 30 (Schütz 2022, 3.3).
/// Half a cell is then less than a quarter of a pixel. It never takes more planes than the node has loaded, nor more
/// than the batch's bits fill.
Precision batchPrecision(const ViewConstants& constants, const NodeData& node, const Batch& batch);

/// A batch that is drawn, cut to the prefix that its item asks for.
struct PlannedBatch {
  const NodeData* node = nullptr;
  std::uint32_t item = 0;        ///< index into RenderList::items
  std::uint32_t firstPoint = 0;  ///< within the node
  std::uint32_t pointCount = 0;
  std::uint32_t firstId = 0;
  Precision precision = Precision::low10;
  bool clipped = false;  ///< some of its points may lie outside DrawOptions::clip, so each must be tested
  bool inside = false;   ///< every point lies in the image, whatever rounding does, so none must be tested
  GridMapping mapping;
};

/// The batches of a list that one view draws.
struct DrawPlan {
  ViewConstants constants;
  std::vector<GridTransform> grids;
  std::vector<PlannedBatch> batches;  ///< in list order
  std::uint64_t pointCount = 0;
  std::uint32_t batchesCulled = 0;         ///< outside the frustum or the clip region, or below the gaze's threshold
  std::uint32_t batchesAt[3] = {0, 0, 0};  ///< by precision
};
/// Decides which batches of `list` are drawn, how many points of each, and with which precision. The plan points into
/// the list's nodes. Its memory is used again from call to call.
void planBatches(const RenderList& list, const View& view, const DrawOptions& options, DrawPlan& plan);
/// The stats of drawing a whole plan, without times.
DrawStats planStats(const DrawPlan& plan);

}  // namespace strata
