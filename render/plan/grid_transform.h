#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "core/draw_options.h"
#include "core/node_data.h"
#include "render/plan/view_constants.h"

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
struct GridMapping {
  std::uint32_t grid = 0;  ///< index into DrawPlan::grids
  glm::ivec3 offset{0};
  glm::ivec3 shift{0};
};

/// The grids of one frame. A grid is found by its step and by one of its points:
/// batches whose corners are whole steps apart share it.
class GridFinder {
 public:
  static constexpr double kLargestOffset = 2.147e9;  ///< steps; a little below 2^31
  /// How many steps a corner may be off the grid and still count as a point of it, because doubles round.
  static constexpr double kOffGrid = 1e-4;

  GridFinder(const ViewConstants& constants, const Clip& clip, std::vector<GridTransform>& grids)
      : constants_(constants), clip_(clip), grids_(grids) {}

  /// The grid of this step that `corner` is a point of, and that corner in steps from the eye's cell.
  struct OnGrid {
    std::uint32_t index;
    glm::dvec3 first;
  };
  std::optional<OnGrid> gridOf(const glm::dvec3& step, const glm::dvec3& corner);
  /// Places a batch on the grid of its store, or on one of its own. Nothing where floats cannot hold its transform.
  std::optional<GridMapping> map(const NodeData& node, const Batch& batch, Precision precision);

 private:
  struct Grid {
    glm::dvec3 step;
    glm::dvec3 point;    ///< of the grid, world
    glm::dvec3 eyeCell;  ///< E, in steps from `point`
    std::uint32_t index;
  };

  const Grid* find(const glm::dvec3& step, const glm::dvec3& corner);
  std::optional<GridMapping> mapAlone(const NodeData& node, const Batch& batch, Precision precision);
  /// `rest`: the origin of d from the eye, metres. False where floats cannot hold the rows.
  bool addTransform(const glm::dvec3& step, const glm::dvec3& rest);

  const ViewConstants& constants_;
  const Clip& clip_;
  std::vector<GridTransform>& grids_;
  std::vector<Grid> known_;
};

}  // namespace strata
