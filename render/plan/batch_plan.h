#pragma once
#include <cstdint>
#include <vector>

#include "core/render_list.h"
#include "core/view.h"
#include "render/plan/grid_transform.h"
#include "render/plan/view_constants.h"
#include "render/rasterizer.h"

namespace strata {

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
  GridMapping mapping;
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
