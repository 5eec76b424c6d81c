#include "viewer/camera/street_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

namespace strata {
namespace {

constexpr double kObstacleCost = 12.0;  // of a full cell, in steps through a free one
constexpr double kNoDataCost = 6.0;     // where nothing was scanned there is nothing to see either
constexpr double kOpenCost = 2.0;       // of a cell with nothing tall in sight: a street runs along something
constexpr int kSight = 3;               // cells
constexpr int kSmoothingRounds = 6;

/// Whether something stands well above the head within kSight cells.
bool somethingTall(const HeightGrid& grid, int column, int row, double eyeHeight) {
  for (int y = std::max(0, row - kSight); y <= std::min(grid.rows() - 1, row + kSight); ++y)
    for (int x = std::max(0, column - kSight); x <= std::min(grid.columns() - 1, column + kSight); ++x)
      if (grid.hasData(x, y) && grid.top(x, y) > grid.ground(column, row) + 3.0 * eyeHeight) return true;
  return false;
}

/// Cost of standing in each cell: how much of it is filled between the knees and above the head.
std::vector<double> cellCosts(const ScanSample& scan, const HeightGrid& grid, double eyeHeight) {
  const std::size_t columns = static_cast<std::size_t>(grid.columns());
  std::vector<double> filled(columns * static_cast<std::size_t>(grid.rows()), 0.0);
  for (const glm::dvec3& p : scan.points) {
    const glm::ivec2 cell = grid.cellOf(glm::dvec2(p));
    const double height = p.z - grid.ground(cell.x, cell.y);
    if (height > 0.3 * eyeHeight && height < 1.6 * eyeHeight)
      filled[static_cast<std::size_t>(cell.y) * columns + static_cast<std::size_t>(cell.x)] += 1.0;
  }
  // A wall through the cell, sampled at the scan's spacing, counts as full.
  const double full = std::max(1.0, grid.cellSize() * eyeHeight / (scan.spacing * scan.spacing));
  std::vector<double> cost(filled.size());
  for (int row = 0; row < grid.rows(); ++row)
    for (int column = 0; column < grid.columns(); ++column) {
      const std::size_t i = static_cast<std::size_t>(row) * columns + static_cast<std::size_t>(column);
      const bool edge = row == 0 || column == 0 || row == grid.rows() - 1 || column == grid.columns() - 1;
      cost[i] = 1.0 + kObstacleCost * std::min(1.0, filled[i] / full) + (edge ? 2.0 : 0.0) +
                (grid.hasData(column, row) ? 0.0 : kNoDataCost) +
                (somethingTall(grid, column, row, eyeHeight) ? 0.0 : kOpenCost);
    }
  return cost;
}

struct Step {
  double cost;
  std::size_t cell;
  bool operator>(const Step& other) const { return cost > other.cost; }
};

/// Cells from `starts` to the cheapest of `goals`.
std::vector<std::size_t> cheapestWay(const HeightGrid& grid, const std::vector<double>& cost,
                                     const std::vector<std::size_t>& starts, const std::vector<std::size_t>& goals) {
  constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  std::vector<double> best(cost.size(), std::numeric_limits<double>::infinity());
  std::vector<std::size_t> from(cost.size(), kNone);
  std::priority_queue<Step, std::vector<Step>, std::greater<>> open;
  for (const std::size_t start : starts) open.push({best[start] = cost[start], start});
  const int columns = grid.columns();
  while (!open.empty()) {
    const Step step = open.top();
    open.pop();
    if (step.cost > best[step.cell]) continue;
    const int column = static_cast<int>(step.cell) % columns;
    const int row = static_cast<int>(step.cell) / columns;
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        const int x = column + dx;
        const int y = row + dy;
        if (x < 0 || y < 0 || x >= columns || y >= grid.rows()) continue;
        const std::size_t next = static_cast<std::size_t>(y * columns + x);
        const double reached = step.cost + cost[next] * std::hypot(dx, dy);
        if (reached >= best[next]) continue;
        best[next] = reached;
        from[next] = step.cell;
        open.push({reached, next});
      }
  }
  std::size_t cell =
      *std::min_element(goals.begin(), goals.end(), [&](std::size_t a, std::size_t b) { return best[a] < best[b]; });
  std::vector<std::size_t> way{cell};
  while (from[cell] != kNone) way.push_back(cell = from[cell]);
  std::reverse(way.begin(), way.end());
  return way;
}

}  // namespace

std::vector<glm::dvec3> findStreet(const ScanSample& scan, const HeightGrid& grid, const glm::dvec2& axis,
                                   double eyeHeight, int stops) {
  const std::vector<double> cost = cellCosts(scan, grid, eyeHeight);
  std::vector<double> along(cost.size());
  for (std::size_t i = 0; i < cost.size(); ++i)
    along[i] = glm::dot(axis, grid.centre(static_cast<int>(i) % grid.columns(), static_cast<int>(i) / grid.columns()));
  const auto [low, high] = std::minmax_element(along.begin(), along.end());
  const double first = *low + 0.12 * (*high - *low);
  const double last = *high - 0.12 * (*high - *low);
  std::vector<std::size_t> starts, goals;
  for (std::size_t i = 0; i < cost.size(); ++i) {
    if (along[i] <= first) starts.push_back(i);
    if (along[i] >= last) goals.push_back(i);
  }
  std::vector<glm::dvec3> way;
  for (const std::size_t cell : cheapestWay(grid, cost, starts, goals)) {
    const int column = static_cast<int>(cell) % grid.columns();
    const int row = static_cast<int>(cell) / grid.columns();
    way.push_back(glm::dvec3(grid.centre(column, row), grid.ground(column, row) + eyeHeight));
  }
  if (way.size() < 2) {
    const double step = std::max(0.25 * scan.diagonal(), 1e-3);
    const glm::dvec3 centre = scan.bounds.centre();
    way = {centre - glm::dvec3(axis * step, 0.0), centre + glm::dvec3(axis * step, 0.0)};
  }
  for (int round = 0; round < kSmoothingRounds; ++round)
    for (std::size_t i = 1; i + 1 < way.size(); ++i) way[i] = 0.25 * way[i - 1] + 0.5 * way[i] + 0.25 * way[i + 1];
  std::vector<glm::dvec3> places;
  for (int i = 0; i < stops; ++i) {
    const double at = static_cast<double>(i) / (stops - 1) * static_cast<double>(way.size() - 1);
    const std::size_t k = std::min(static_cast<std::size_t>(at), way.size() - 2);
    places.push_back(glm::mix(way[k], way[k + 1], at - static_cast<double>(k)));
  }
  return places;
}

}  // namespace strata
