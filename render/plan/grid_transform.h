#pragma once
#include <optional>

#include "render/plan/batch_plan.h"

namespace strata {

/// The grids of one frame; see batch_plan.h for the arithmetic. A grid is found by its step and by one of its points:
/// batches whose corners are whole steps apart share it.
class GridFinder {
 public:
  GridFinder(const ViewConstants& constants, const Clip& clip, std::vector<GridTransform>& grids)
      : constants_(constants), clip_(clip), grids_(grids) {}

  /// The grid of this step that `corner` is a point of, and that corner in steps from the eye's cell.
  struct OnGrid {
    std::uint32_t index;
    glm::dvec3 first;
  };
  std::optional<OnGrid> gridOf(const glm::dvec3& step, const glm::dvec3& corner);
  /// Places a batch on the grid of its store, or on one of its own. Nothing where floats cannot hold its transform.
  std::optional<GridPlace> place(const NodeData& node, const Batch& batch, Precision precision);

 private:
  struct Grid {
    glm::dvec3 step;
    glm::dvec3 point;    ///< of the grid, world
    glm::dvec3 eyeCell;  ///< E, in steps from `point`
    std::uint32_t index;
  };

  const Grid* find(const glm::dvec3& step, const glm::dvec3& corner);
  std::optional<GridPlace> placeAlone(const NodeData& node, const Batch& batch, Precision precision);
  /// `rest`: the origin of d from the eye, metres. False where floats cannot hold the rows.
  bool addTransform(const glm::dvec3& step, const glm::dvec3& rest);

  const ViewConstants& constants_;
  const Clip& clip_;
  std::vector<GridTransform>& grids_;
  std::vector<Grid> known_;
};

}  // namespace strata
