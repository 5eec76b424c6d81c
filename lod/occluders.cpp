#include "lod/occluders.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <numeric>
#include <span>

#include <glm/gtc/type_precision.hpp>

namespace strata {
namespace {

constexpr int kCells = OccluderSet::kCells;
constexpr std::size_t kCellCount = std::size_t{kCells} * kCells * kCells;
constexpr int kGrid = OccluderSet::kFinestGrid;
constexpr float kLayer = 0.04f;      // half the thickness of a layer, in cells: 1 cm where a cell has 25
constexpr float kLeastArea = 0.05f;  // of an occluder, in sides of a cell squared: slivers are not worth their time

/// A plane in a cell, seen along its steepest axis as a height over the other two. Coordinates from the cell's
/// centre in sides of the cell.
struct CellPlane {
  glm::vec3 normal{0.0f};
  float offset = 0.0f;
  std::size_t u = 0, v = 1, w = 2;             ///< w is the axis that the normal is nearest to
  std::array<std::uint16_t, kGrid> squares{};  ///< rows of v, bits of u: points near the plane

  float height(float atU, float atV) const {
    return (offset - normal[static_cast<glm::length_t>(u)] * atU - normal[static_cast<glm::length_t>(v)] * atV) /
           normal[static_cast<glm::length_t>(w)];
  }
};

/// The node's points sorted by cell, each as its place in the cell in 1/1024 of the cell's side.
class PointsByCell {
 public:
  PointsByCell(const NodeData& node, const Box& cube, int cellsAlong) {
    const double perMetre = 1024.0 * cellsAlong / cube.size().x;
    std::vector<glm::ivec3> places(node.pointCount());
    for (const Batch& batch : node.batches) {
      glm::vec3 start, step;
      for (glm::length_t axis = 0; axis < 3; ++axis) {
        const double half = batch.bits[axis] > 10 ? 0.5 : 0.0;
        const double metres = batch.boxSize[axis] / 1024.0;
        step[axis] = static_cast<float>(metres * perMetre);
        start[axis] =
            static_cast<float>((node.origin[axis] + batch.boxMin[axis] - cube.min[axis] + half * metres) * perMetre);
      }
      const std::uint32_t* const positions = node.position[0].data() + batch.firstPoint;
      glm::ivec3* const out = places.data() + batch.firstPoint;
      for (std::uint32_t i = 0; i < batch.pointCount; ++i) {
        const std::uint32_t p = positions[i];
        const auto place = [&](glm::length_t axis, std::uint32_t coordinate) {
          const int at = static_cast<int>(start[axis] + step[axis] * static_cast<float>(static_cast<int>(coordinate)));
          return std::min(std::max(at, 0), 1024 * cellsAlong - 1);
        };
        out[i] = {place(0, p & 1023), place(1, p >> 10 & 1023), place(2, p >> 20)};
      }
    }
    std::vector<std::uint16_t> cells(places.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
      const glm::ivec3 cell = places[i] >> 10;
      cells[i] = static_cast<std::uint16_t>((cell.x * kCells + cell.y) * kCells + cell.z);
      ++start_[cells[i] + std::size_t{1}];
    }
    std::partial_sum(start_.begin(), start_.end(), start_.begin());
    std::array<std::uint32_t, kCellCount> next;
    std::copy_n(start_.begin(), kCellCount, next.begin());
    points_.resize(places.size());
    for (std::size_t i = 0; i < places.size(); ++i) points_[next[cells[i]]++] = glm::u16vec3(places[i] & 1023);
  }

  std::span<const glm::u16vec3> of(std::size_t cell) const {
    return {points_.data() + start_[cell], points_.data() + start_[cell + 1]};
  }

 private:
  std::array<std::uint32_t, kCellCount + 1> start_{};
  std::vector<glm::u16vec3> points_;
};

/// To coordinates from the cell's centre in sides of the cell.
glm::vec3 placeInCell(const glm::u16vec3& point) { return (glm::vec3(point) + 0.5f) / 1024.0f - 0.5f; }

/// Eigenvector of the smallest eigenvalue of a symmetric matrix (xx yy zz xy xz yz); zero where it is not unique.
/// Eigenvalues in closed form (Smith 1961); the vector is the longest cross product of two rows of A - λ.
glm::vec3 smallestAxis(const std::array<double, 6>& a) {
  const double mean = (a[0] + a[1] + a[2]) / 3.0;
  const double off = a[3] * a[3] + a[4] * a[4] + a[5] * a[5];
  const double p2 = (a[0] - mean) * (a[0] - mean) + (a[1] - mean) * (a[1] - mean) + (a[2] - mean) * (a[2] - mean);
  const double p = std::sqrt((p2 + 2.0 * off) / 6.0);
  if (!(p > 0.0)) return glm::vec3(0.0f);
  const double b0 = (a[0] - mean) / p, b1 = (a[1] - mean) / p, b2 = (a[2] - mean) / p;
  const double b3 = a[3] / p, b4 = a[4] / p, b5 = a[5] / p;
  const double halfDet = 0.5 * (b0 * (b1 * b2 - b5 * b5) - b3 * (b3 * b2 - b5 * b4) + b4 * (b3 * b5 - b1 * b4));
  const double angle = std::acos(std::clamp(halfDet, -1.0, 1.0)) / 3.0;
  const double smallest = mean + 2.0 * p * std::cos(angle + 2.0 * std::numbers::pi / 3.0);
  const glm::dvec3 rows[3] = {
      {a[0] - smallest, a[3], a[4]}, {a[3], a[1] - smallest, a[5]}, {a[4], a[5], a[2] - smallest}};
  glm::dvec3 best(0.0);
  for (int i = 0; i < 3; ++i) {
    const glm::dvec3 c = glm::cross(rows[i], rows[(i + 1) % 3]);
    if (glm::dot(c, c) > glm::dot(best, best)) best = c;
  }
  const double length = glm::length(best);
  return length > 1e-12 ? glm::vec3(best / length) : glm::vec3(0.0f);
}

void setNormal(const glm::vec3& normal, CellPlane& plane) {
  plane.normal = normal;
  const glm::vec3 steep = glm::abs(normal);
  plane.w = steep.x >= steep.y && steep.x >= steep.z ? 0 : steep.y >= steep.z ? 1 : 2;
  plane.u = (plane.w + 1) % 3;
  plane.v = (plane.w + 2) % 3;
}

/// The plane through the points' mean across their smallest principal axis. False where there is none.
bool fitPlane(std::span<const glm::u16vec3> points, CellPlane& plane) {
  std::int64_t sum[3] = {}, product[6] = {};
  for (const glm::u16vec3& p : points) {
    const std::int32_t x = p.x, y = p.y, z = p.z;
    sum[0] += x, sum[1] += y, sum[2] += z;
    product[0] += x * x, product[1] += y * y, product[2] += z * z;
    product[3] += x * y, product[4] += x * z, product[5] += y * z;
  }
  const auto n = static_cast<double>(points.size());
  const glm::dvec3 mean =
      glm::dvec3(static_cast<double>(sum[0]), static_cast<double>(sum[1]), static_cast<double>(sum[2])) / n;
  const auto spread = [&](int k, glm::length_t i, glm::length_t j) {
    return static_cast<double>(product[k]) / n - mean[i] * mean[j];
  };
  setNormal(smallestAxis(
                {spread(0, 0, 0), spread(1, 1, 1), spread(2, 2, 2), spread(3, 0, 1), spread(4, 0, 2), spread(5, 1, 2)}),
            plane);
  plane.offset = glm::dot(plane.normal, (glm::vec3(mean) + 0.5f) / 1024.0f - 0.5f);
  return std::abs(plane.normal[static_cast<glm::length_t>(plane.w)]) > 0.5f;
}

/// Notes in which squares there are points within `layer` of the plane.
void markSquares(std::span<const glm::u16vec3> points, float layer, CellPlane& plane) {
  const auto u = static_cast<glm::length_t>(plane.u), v = static_cast<glm::length_t>(plane.v);
  plane.squares.fill(0);
  constexpr int kShift = std::countr_zero(1024u / kGrid);
  for (const glm::u16vec3& point : points) {
    const bool near = std::abs(glm::dot(plane.normal, placeInCell(point)) - plane.offset) <= layer;
    std::uint16_t& row = plane.squares[point[v] >> kShift];
    row = static_cast<std::uint16_t>(row | static_cast<std::uint32_t>(near) << (point[u] >> kShift));
  }
}

/// Whether each square of a grid of `side` x `side` holds a point, or need not: the plane leaves the cell there.
bool isClosed(const CellPlane& plane, int side) {
  const int each = kGrid / side;
  const float size = 1.0f / static_cast<float>(side);
  const float slope = (std::abs(plane.normal[static_cast<glm::length_t>(plane.u)]) +
                       std::abs(plane.normal[static_cast<glm::length_t>(plane.v)])) /
                      std::abs(plane.normal[static_cast<glm::length_t>(plane.w)]);
  const float inside = 0.5f - 0.5f * size * slope;
  int needed = 0;
  for (int row = 0; row < side; ++row) {
    std::uint32_t points = 0;
    for (int i = 0; i < each; ++i) points |= plane.squares[static_cast<std::size_t>(row * each + i)];
    for (int column = 0; column < side; ++column) {
      const float height = plane.height((static_cast<float>(column) + 0.5f) * size - 0.5f,
                                        (static_cast<float>(row) + 0.5f) * size - 0.5f);
      if (std::abs(height) > inside) continue;
      ++needed;
      if ((points >> (column * each) & ((1u << each) - 1)) == 0) return false;
    }
  }
  return needed > 0;
}

/// The part of the plane inside the cell: the cell's square lifted to the plane, clipped at the cell's top and bottom.
/// Coordinates as in CellPlane.
void clipToCell(const CellPlane& plane, Occluder& out) {
  std::array<glm::vec3, 8> polygon, clipped;
  std::size_t count = 4;
  const auto w = static_cast<glm::length_t>(plane.w);
  for (std::size_t i = 0; i < 4; ++i) {
    const float atU = i == 1 || i == 2 ? 0.5f : -0.5f;
    const float atV = i >= 2 ? 0.5f : -0.5f;
    polygon[i][static_cast<glm::length_t>(plane.u)] = atU;
    polygon[i][static_cast<glm::length_t>(plane.v)] = atV;
    polygon[i][w] = plane.height(atU, atV);
  }
  for (const float sign : {-1.0f, 1.0f}) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const glm::vec3& a = polygon[i];
      const glm::vec3& b = polygon[(i + 1) % count];
      const float insideA = 0.5f - sign * a[w], insideB = 0.5f - sign * b[w];
      if (insideA >= 0.0f) clipped[kept++] = a;
      if ((insideA >= 0.0f) != (insideB >= 0.0f)) clipped[kept++] = glm::mix(a, b, insideA / (insideA - insideB));
    }
    count = kept;
    polygon = clipped;
  }
  out.corners = static_cast<std::uint32_t>(std::min(count, Occluder::kMaxCorners));
  for (std::size_t i = 0; i < out.corners; ++i) out.corner[i] = polygon[i];
}

float areaOf(const Occluder& occluder) {
  glm::vec3 twice(0.0f);
  for (std::size_t i = 2; i < occluder.corners; ++i)
    twice += glm::cross(occluder.corner[i - 1] - occluder.corner[0], occluder.corner[i] - occluder.corner[0]);
  return 0.5f * glm::length(twice);
}

/// So many that those which a surface crosses have about a hundred points: three sides of the cube have 3 n² of them.
int cellsFor(std::uint32_t points) {
  int cells = kCells;
  while (cells > 4 && points < 80u * 3u * static_cast<std::uint32_t>(cells * cells)) cells /= 2;
  return cells;
}

glm::ivec3 cellAt(std::size_t cell) {
  return {static_cast<int>(cell / (kCells * kCells)), static_cast<int>(cell / kCells % kCells),
          static_cast<int>(cell % kCells)};
}

/// Finds the closed planes of a node's cells.
class Finder {
 public:
  Finder(const NodeData& node, const Box& cube, int cellsAlong, float layer)
      : points_(node, cube, cellsAlong), cellsAlong_(cellsAlong), layer_(layer) {}

  struct Found {
    std::size_t cell = 0;
    CellPlane plane;
    int grid = 0;
  };

  std::vector<Found> find() {
    for (std::size_t cell = 0; cell < kCellCount; ++cell) {
      CellPlane plane;
      if (points_.of(cell).size() >= OccluderSet::kLeastPoints && fitPlane(points_.of(cell), plane))
        tryPlane(cell, plane);
    }
    // Where a wall meets the floor or has something before it, the points of a cell lie in no one plane; that of the
    // cell beside it is then tried. What is found goes on to the next cell.
    for (std::size_t i = 0; i < found_.size() && found_.size() < OccluderSet::kMost; ++i) {
      const std::size_t cell = found_[i].cell;
      for (int axis = 0; axis < 3; ++axis)
        for (const int side : {-1, 1}) {
          glm::ivec3 beside = cellAt(cell);
          beside[axis] += side;
          if (beside[axis] < 0 || beside[axis] >= cellsAlong_) continue;
          CellPlane plane = found_[i].plane;
          plane.offset -= plane.normal[axis] * static_cast<float>(side);
          const auto to = static_cast<std::size_t>((beside.x * kCells + beside.y) * kCells + beside.z);
          if (crosses(plane) && !isKnown(to, plane)) tryPlane(to, plane);
        }
    }
    return std::move(found_);
  }

 private:
  static bool crosses(const CellPlane& plane) {
    const glm::vec3 steep = glm::abs(plane.normal);
    return std::abs(plane.offset) < 0.5f * (steep.x + steep.y + steep.z);
  }

  /// True when the cell has a plane so like this one that a second would tell nothing new, or enough of them.
  bool isKnown(std::size_t cell, const CellPlane& plane) const {
    std::size_t known = 0;
    for (std::uint32_t at = first_[cell]; at != 0; at = next_[at - 1]) {
      if (++known == OccluderSet::kMostACell) return true;
      const CellPlane& other = found_[at - 1].plane;
      if (std::abs(glm::dot(other.normal, plane.normal)) > 0.95f &&
          std::abs(std::abs(other.offset) - std::abs(plane.offset)) < 4.0f * layer_)
        return true;
    }
    return false;
  }

  void tryPlane(std::size_t cell, CellPlane& plane) {
    const std::span<const glm::u16vec3> points = points_.of(cell);
    if (points.size() < OccluderSet::kLeastPoints || found_.size() >= OccluderSet::kMost) return;
    markSquares(points, layer_, plane);
    int grid = kGrid;
    while (grid >= OccluderSet::kCoarsestGrid && !isClosed(plane, grid)) grid /= 2;
    if (grid < OccluderSet::kCoarsestGrid) return;
    found_.push_back({cell, plane, grid});
    next_.push_back(first_[cell]);
    first_[cell] = static_cast<std::uint32_t>(found_.size());
  }

  const PointsByCell points_;
  const int cellsAlong_;
  const float layer_;  ///< half its thickness, in sides of a cell
  std::vector<Found> found_;
  // The planes of a cell: a list through found_, by position + 1.
  std::array<std::uint32_t, kCellCount> first_{};
  std::vector<std::uint32_t> next_;
};

}  // namespace

void findOccluders(const NodeData& node, const Box& cube, std::uint8_t childMask, OccluderSet& out) {
  out.occluders.clear();
  out.origin = cube.centre();
  const int cellsAlong = cellsFor(node.pointCount());
  const double side = cube.size().x / cellsAlong;
  out.cellSide = side;
  if (!(side > 0.0) || node.pointCount() < OccluderSet::kLeastPoints) return;
  double coarseness = 0.0;  // of the positions used, in cells
  for (const Batch& batch : node.batches)
    for (glm::length_t axis = 0; axis < 3; ++axis)
      if (batch.bits[axis] > 10) coarseness = std::max(coarseness, batch.boxSize[axis] / 2048.0 / side);
  const float layer = kLayer + static_cast<float>(coarseness);
  const auto metres = static_cast<float>(side);
  const std::vector<Finder::Found> all = Finder(node, cube, cellsAlong, layer).find();
  out.occluders.reserve(all.size());
  for (const Finder::Found& found : all) {
    const CellPlane& plane = found.plane;
    Occluder occluder;
    clipToCell(plane, occluder);
    if (occluder.corners < 3 || areaOf(occluder) < kLeastArea) continue;
    const glm::ivec3 at = cellAt(found.cell);
    const glm::vec3 centre = glm::vec3(at) + 0.5f - 0.5f * static_cast<float>(cellsAlong);
    for (std::size_t k = 0; k < occluder.corners; ++k) occluder.corner[k] = (occluder.corner[k] + centre) * metres;
    occluder.normal = plane.normal;
    occluder.offset = (plane.offset + glm::dot(plane.normal, centre)) * metres;
    const float square = metres / static_cast<float>(found.grid);
    occluder.gap = square / std::abs(plane.normal[static_cast<glm::length_t>(plane.w)]);
    occluder.back = layer * metres + 0.5f * occluder.gap;
    const int half = cellsAlong / 2;
    const int octant = (at.x >= half ? 4 : 0) + (at.y >= half ? 2 : 0) + (at.z >= half ? 1 : 0);
    occluder.whole = (childMask >> octant & 1) == 0;
    out.occluders.push_back(occluder);
  }
}

}  // namespace strata
