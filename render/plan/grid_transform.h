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
// A store keeps positions as integers of its grid. A point drawn with 10, 20 or 30 bits lies on that grid too, because
// it is drawn in the middle of a cell whose sides are a power of two of the grid's step (see NodeData). So every
// rasterizer computes, for a coordinate X of a point and E, the point of the grid that is nearest to the eye:
//
//   D = (X << shift) + offset      grid steps from E, an integer of 32 bits per axis
//   d = float(D)                   rounded once, to nearest even; exact where |D| <= 2^24
//   x     = step.x*d.x + (step.y*d.y + (step.z*d.z + base))      three fused multiply-adds; y, depth likewise
//   w     = depth (perspective) or 1 (orthographic)
//   pixel = (floor(x / w + width/2), floor(y / w + height/2))
//
// It draws the point where near <= depth and the pixel lies in the image. `offset` and `shift` belong to the batch; a
// negative shift goes to the right, and the bits that it drops are 0. The rows x, y and depth are the same for all
// batches of a store and are computed in double, once per draw.
//
// Tie rule: points of one store at the same position have the same D, whichever node, batch and precision they come
// from. So they have the same pixel and the same depth to the last bit, and the lower id wins.
//
// Each term is at most |row| * |d| and is rounded to 24 bits. That amounts to a few 1e-4 pixels at 1920 columns,
// whatever the coordinates, and also where the eye is inside the batch.
//
// A batch that does not fit 32 bits of steps (farther away than 2100 km at steps of 1 mm) has rows of its own: its
// cells are the steps, and E is at most one box away from it. Rounding settles its ties with other batches.

/// A clip box in grid steps from E: a point is inside where lo <= d <= hi.
struct ClipSteps {
  glm::vec3 lo, hi;
};

/// One grid as a view sees it. Each row is a linear function of a grid position: w is its value at the origin of the
/// grid, and x, y and z are what one step along each axis adds.
struct GridTransform {
  glm::vec4 x, y, depth;
  std::vector<ClipSteps> clipBoxes, clipCutouts;
  std::vector<glm::vec4> clipPlanes;  ///< rows; a point is inside where the value is >= 0
};

/// How the coordinates of a batch become steps of its grid: D = (X << shift) + offset, or (X >> -shift) + offset.
struct GridMapping {
  std::uint32_t grid = 0;  ///< index into DrawPlan::grids
  glm::ivec3 offset{0};
  glm::ivec3 shift{0};
};

/// Collects the grids that one view draws. Batches share a grid when their steps are equal and their corners lie whole
/// steps apart.
class GridFinder {
 public:
  static constexpr double kLargestOffset = 2.147e9;  ///< steps; a little below 2^31
  /// How many steps a corner may be off the grid and still count as a point of it, because doubles round.
  static constexpr double kOffGrid = 1e-4;

  GridFinder(const ViewConstants& constants, const Clip& clip, std::vector<GridTransform>& grids)
      : constants_(constants), clip_(clip), grids_(grids) {}

  /// A point of a grid that is already known.
  struct OnGrid {
    std::uint32_t index;  ///< into the grids
    glm::dvec3 first;     ///< steps from E, whole numbers
  };
  /// Finds the grid of this step (metres) that the point `corner` (world) belongs to, and adds it where it is new.
  /// Nothing where the grid's numbers would be too large.
  std::optional<OnGrid> gridOf(const glm::dvec3& step, const glm::dvec3& corner);
  /// Maps a batch to the grid of its store, or to one of its own. Nothing where floats cannot hold its transform.
  std::optional<GridMapping> map(const NodeData& node, const Batch& batch, Precision precision);

 private:
  struct Grid {
    glm::dvec3 step;
    glm::dvec3 point;    ///< one of the grid's points, world
    glm::dvec3 eyeCell;  ///< E, in steps from `point`
    std::uint32_t index;
  };

  const Grid* find(const glm::dvec3& step, const glm::dvec3& corner);
  std::optional<GridMapping> mapAlone(const NodeData& node, const Batch& batch, Precision precision);
  /// Adds the transform of a grid. `rest` leads from the eye to E, metres. False where floats cannot hold the rows.
  bool addTransform(const glm::dvec3& step, const glm::dvec3& rest);

  const ViewConstants& constants_;
  const Clip& clip_;
  std::vector<GridTransform>& grids_;
  std::vector<Grid> known_;
};

}  // namespace strata
