#include "render/plan/grid_transform.h"

#include <algorithm>
#include <cmath>

namespace strata {
namespace {

constexpr double kLargestFloat = 1e30;    ///< beyond it products of floats may overflow
constexpr double kLargestSteps = 1.0e15;  ///< steps that a double counts exactly, with room to spare
constexpr std::size_t kMostGrids = 64;    ///< grids that batches share; further batches have grids of their own

bool usable(const glm::vec4& row) {
  for (int i = 0; i < 4; ++i)
    if (!(std::abs(static_cast<double>(row[i])) < kLargestFloat)) return false;
  return true;
}

bool countable(const glm::dvec3& steps) {
  return std::abs(steps.x) < kLargestSteps && std::abs(steps.y) < kLargestSteps && std::abs(steps.z) < kLargestSteps;
}

}  // namespace

const GridFinder::Grid* GridFinder::find(const glm::dvec3& step, const glm::dvec3& corner) {
  if (!(std::min({step.x, step.y, step.z}) > 0.0)) return nullptr;
  for (const Grid& grid : known_) {
    if (grid.step != step) continue;
    const glm::dvec3 steps = (corner - grid.point) / step;
    const glm::dvec3 off = glm::abs(steps - glm::round(steps));
    if (countable(steps) && std::max({off.x, off.y, off.z}) < kOffGrid) return &grid;
  }
  // A new grid: E is the point of the grid next to the eye, so that d is smallest, and exact, where it matters most.
  const glm::dvec3 eyeCell = glm::round((constants_.view.eye - corner) / step);
  if (known_.size() >= kMostGrids || !countable(eyeCell)) return nullptr;
  if (!addTransform(step, (corner - constants_.view.eye) + eyeCell * step)) return nullptr;
  known_.push_back({step, corner, eyeCell, static_cast<std::uint32_t>(grids_.size() - 1)});
  return &known_.back();
}

bool GridFinder::addTransform(const glm::dvec3& step, const glm::dvec3& rest) {
  // A row for metres from the eye becomes one for steps from E: scaled by the step, with E's own value as the base.
  const auto fold = [&](const glm::dvec4& row) {
    const glm::dvec3 direction(row);
    return glm::vec4(glm::dvec4(direction * step, glm::dot(direction, rest) + row.w));
  };
  GridTransform t;
  t.x = fold(constants_.rowX);
  t.y = fold(constants_.rowY);
  t.depth = fold(constants_.projection.rowDepth);
  if (!usable(t.x) || !usable(t.y) || !usable(t.depth)) return false;
  const glm::dvec3 origin = constants_.view.eye + rest;
  const glm::dvec3 least = glm::max(step, 1e-300);  // a flat box has steps of 0
  const auto inSteps = [&](const Box& box) {
    return ClipSteps{glm::vec3((box.min - origin) / least), glm::vec3((box.max - origin) / least)};
  };
  for (const Box& box : clip_.boxes) t.clipBoxes.push_back(inSteps(box));
  for (const Box& box : clip_.cutouts) t.clipCutouts.push_back(inSteps(box));
  for (const glm::dvec4& plane : clip_.planes)
    t.clipPlanes.push_back(fold(glm::dvec4(glm::dvec3(plane), glm::dot(plane, glm::dvec4(constants_.view.eye, 1.0)))));
  grids_.push_back(std::move(t));
  return true;
}

std::optional<GridFinder::OnGrid> GridFinder::gridOf(const glm::dvec3& step, const glm::dvec3& corner) {
  const Grid* grid = find(step, corner);
  if (grid == nullptr) return std::nullopt;
  return OnGrid{grid->index, glm::round((corner - grid->point) / grid->step) - grid->eyeCell};
}

std::optional<GridMapping> GridFinder::map(const NodeData& node, const Batch& batch, Precision precision) {
  const glm::dvec3 steps = glm::exp2(glm::dvec3(batch.bits));
  const glm::dvec3 corner = node.origin + batch.boxMin;
  const std::optional<OnGrid> grid = gridOf(batch.boxSize / steps, corner);
  if (!grid) return mapAlone(node, batch, precision);
  const glm::dvec3& first = grid->first;
  GridMapping mapping;
  mapping.grid = grid->index;
  for (int axis = 0; axis < 3; ++axis) {
    if (!(std::abs(first[axis]) + steps[axis] < kLargestOffset)) return mapAlone(node, batch, precision);
    mapping.shift[axis] = batch.bits[axis] - 10 * static_cast<int>(precision);
    // A coordinate with fewer bits than the grid stands for a cell of 2^shift steps, and its point lies in the middle.
    const int half = mapping.shift[axis] > 0 ? 1 << (mapping.shift[axis] - 1) : 0;
    mapping.offset[axis] = static_cast<int>(first[axis]) + half;
  }
  return mapping;
}

std::optional<GridMapping> GridFinder::mapAlone(const NodeData& node, const Batch& batch, Precision precision) {
  const int bits = 10 * static_cast<int>(precision);
  const double cells = static_cast<double>(1u << bits);
  const glm::dvec3 lo = (node.origin - constants_.view.eye) + batch.boxMin;
  GridMapping mapping;
  glm::dvec3 cell, rest;
  for (int axis = 0; axis < 3; ++axis) {
    cell[axis] = batch.boxSize[axis] / cells;
    const double half = batch.bits[axis] > bits ? 0.5 : 0.0;
    const double first = lo[axis] + half * cell[axis];  // position of X = 0
    double eyeCell = cell[axis] > 0.0 ? std::round(-first / cell[axis]) : 0.0;
    eyeCell = std::clamp(eyeCell, -0.9 * cells, 1.9 * cells);
    if (!std::isfinite(eyeCell)) return std::nullopt;
    eyeCell = std::round(eyeCell);  // clamped above, so X - E fits 32 bits
    mapping.offset[axis] = -static_cast<int>(eyeCell);
    rest[axis] = first + eyeCell * cell[axis];
  }
  if (!addTransform(cell, rest)) return std::nullopt;
  mapping.grid = static_cast<std::uint32_t>(grids_.size() - 1);
  return mapping;
}

}  // namespace strata
