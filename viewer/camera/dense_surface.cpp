#include "viewer/camera/dense_surface.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <unordered_map>

#include "io/store/node_codec.h"

namespace strata {
namespace {

constexpr int kCellsAcross = 40;  // of the ball that is searched
constexpr int kReach = 2;         // cells on each side that have to be dense too
constexpr double kEnough = 0.8;   // share of the cells that hold fewer points than what counts as full

using Cell = std::tuple<int, int, int>;

struct CellHash {
  std::size_t operator()(const Cell& c) const {
    const auto mix = [](int value, std::uint64_t factor) { return static_cast<std::uint64_t>(value) * factor; };
    return mix(std::get<0>(c), 73856093u) ^ mix(std::get<1>(c), 19349663u) ^ mix(std::get<2>(c), 83492791u);
  }
};

struct Content {
  glm::dvec3 sum{0.0};
  double count = 0.0;
};

/// Half the extent of a contour's axis-aligned box.
glm::dvec3 halfExtent(const NodeRecord& node) {
  glm::dvec3 half(0.0);
  for (const auto& axis : node.halfAxis)
    for (int i = 0; i < 3; ++i) half[i] += std::abs(static_cast<double>(axis[i]));
  return half;
}

std::vector<std::uint32_t> nodesInBall(const Store& store, const glm::dvec3& centre, double radius) {
  std::vector<std::uint32_t> found;
  const std::vector<NodeRecord>& nodes = store.hierarchy().nodes;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const glm::dvec3 middle(nodes[i].centre[0], nodes[i].centre[1], nodes[i].centre[2]);
    const glm::dvec3 outside = glm::max(glm::abs(centre - middle) - halfExtent(nodes[i]), 0.0);
    if (glm::length(outside) <= radius) found.push_back(static_cast<std::uint32_t>(i));
  }
  return found;
}

}  // namespace

DensePlace densestAmong(const std::vector<glm::dvec3>& points, double resolution) {
  if (points.empty()) return {};
  std::unordered_map<Cell, Content, CellHash> cells;
  for (const glm::dvec3& p : points) {
    const glm::dvec3 at = glm::floor((p - points.front()) / resolution);
    Content& content = cells[{static_cast<int>(at.x), static_cast<int>(at.y), static_cast<int>(at.z)}];
    content.sum += p;
    content.count += 1.0;
  }
  std::vector<double> counts;
  for (const auto& [cell, content] : cells) counts.push_back(content.count);
  const auto nth = counts.begin() + static_cast<std::ptrdiff_t>(kEnough * static_cast<double>(counts.size() - 1));
  std::nth_element(counts.begin(), nth, counts.end());
  const double full = std::max(*nth, 1.0);

  DensePlace best;
  double bestScore = -1.0;
  Cell bestCell{};
  for (const auto& [cell, content] : cells) {
    const auto [x, y, z] = cell;
    double score = 0.0;
    double inside = 0.0;
    double occupied = 0.0;
    for (int dz = -kReach; dz <= kReach; ++dz)
      for (int dy = -kReach; dy <= kReach; ++dy)
        for (int dx = -kReach; dx <= kReach; ++dx) {
          const auto near = cells.find({x + dx, y + dy, z + dz});
          if (near == cells.end()) continue;
          // Beyond full, more points are a scanner's own neighbourhood, not more to see.
          score += std::min(near->second.count / full, 1.0);
          inside += near->second.count;
          occupied += 1.0;
        }
    if (score < bestScore || (score == bestScore && cell >= bestCell)) continue;
    bestScore = score;
    bestCell = cell;
    best.centre = content.sum / content.count;
    best.spacing = resolution * std::sqrt(occupied / inside);
  }
  return best;
}

DensePlace densePlace(const Store& store, const glm::dvec3& centre, double radius) {
  std::vector<std::uint32_t> wanted;
  for (int round = 0; round < 20; ++round, radius *= 0.7) {
    wanted = nodesInBall(store, centre, radius);
    std::uint64_t inside = 0;
    for (const std::uint32_t node : wanted) inside += store.hierarchy().nodes[node].pointCount;
    if (inside <= kMostRead) break;
  }
  std::vector<glm::dvec3> points;
  NodeData node;
  for (const std::uint32_t index : wanted) {
    readForDrawing(store, index, Precision::medium20, node);
    for (const Batch& batch : node.batches)
      for (std::uint32_t i = 0; i < batch.pointCount; ++i) {
        const glm::dvec3 p = pointPosition(node, batch, batch.firstPoint + i, Precision::medium20);
        if (glm::distance(p, centre) <= radius) points.push_back(p);
      }
  }
  if (points.empty()) return {centre, localNode(store, centre).spacing};
  return densestAmong(points, 2.0 * radius / kCellsAcross);
}

}  // namespace strata
