#include "lod/occluders.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "core/instruction_sets.h"
#include "lod/cell_surface.h"

namespace strata {
namespace {

constexpr int kCells = OccluderSet::kCells;
constexpr std::size_t kCellCount = std::size_t{kCells} * kCells * kCells;
constexpr float kLayer = 0.04f;         // half the thickness of a layer in cells: 1 cm where a cell is 25 cm wide
constexpr int kLeastPart = 8;           // a part of a cell has at least 1 / kLeastPart of its squares
constexpr std::size_t kMostSpread = 3;  // a cell with so many surfaces tries none of its neighbours'
constexpr std::size_t kMostParts = 2;   // parts of a surface in a cell that is not closed
constexpr float kLeastArea = 0.05f;     // least area of an occluder in cell faces: slivers are not worth their time

/// How a batch's leading 10 bits become places in the node's cube, in 1/1024 of a cell: start + step * coordinate.
struct CubeFrame {
  glm::vec3 start{0.0f}, step{0.0f};
  int cellsAlong = 0;
};

/// Finds the cell of each point and its place in the cell. Points that rounding puts outside of the cube are moved in.
inline __attribute__((always_inline)) void placeBatch(std::span<const std::uint32_t> positions, const CubeFrame& frame,
                                                      CellPoint* points, std::uint16_t* cells) {
  const glm::vec3 start = frame.start, step = frame.step;
  const float last = static_cast<float>(1024 * frame.cellsAlong - 1);
  const auto place = [last](float from, float each, std::uint32_t coordinate) {
    const float at = from + each * static_cast<float>(static_cast<int>(coordinate));
    return static_cast<std::uint32_t>(static_cast<int>(std::min(std::max(at, 0.0f), last)));
  };
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const std::uint32_t p = positions[i];
    const std::uint32_t x = place(start.x, step.x, p & 1023), y = place(start.y, step.y, p >> 10 & 1023),
                        z = place(start.z, step.z, p >> 20);
    points[i] = (x & 1023) | (y & 1023) << 10 | (z & 1023) << 20;
    cells[i] = static_cast<std::uint16_t>(((x >> 10) * kCells + (y >> 10)) * kCells + (z >> 10));
  }
}
void placeBatchPlain(std::span<const std::uint32_t> positions, const CubeFrame& frame, CellPoint* points,
                     std::uint16_t* cells) {
  placeBatch(positions, frame, points, cells);
}
STRATA_TARGET_AVX2 void placeBatchAvx2(std::span<const std::uint32_t> positions, const CubeFrame& frame,
                                       CellPoint* points, std::uint16_t* cells) {
  placeBatch(positions, frame, points, cells);
}

/// The node's points sorted by cell.
class PointsByCell {
 public:
  PointsByCell(const NodeData& node, const Box& cube, int cellsAlong) {
    const std::size_t count = node.pointCount();
    std::vector<CellPoint> places(count);
    std::vector<std::uint16_t> cells(count);
    for (const Batch& batch : node.batches) {
      const CubeFrame frame = frameOf(node, batch, cube, cellsAlong);
      const auto place = hasAvx2() ? placeBatchAvx2 : placeBatchPlain;
      place({node.position[0].data() + batch.firstPoint, batch.pointCount}, frame, places.data() + batch.firstPoint,
            cells.data() + batch.firstPoint);
    }
    sort(places, cells);
  }

  std::span<const CellPoint> of(std::size_t cell) const {
    return {points_.data() + start_[cell], points_.data() + start_[cell + 1]};
  }

 private:
  static CubeFrame frameOf(const NodeData& node, const Batch& batch, const Box& cube, int cellsAlong) {
    const double perMetre = 1024.0 * cellsAlong / cube.size().x;
    CubeFrame frame;
    frame.cellsAlong = cellsAlong;
    for (glm::length_t axis = 0; axis < 3; ++axis) {
      const double half = batch.bits[axis] > 10 ? 0.5 : 0.0;  // as in NodeData's formula for one plane
      const double metres = batch.boxSize[axis] / 1024.0;
      frame.step[axis] = static_cast<float>(metres * perMetre);
      frame.start[axis] =
          static_cast<float>((node.origin[axis] + batch.boxMin[axis] - cube.min[axis] + half * metres) * perMetre);
    }
    return frame;
  }

  /// A counting sort. It goes through the first and the second half of the points at once, each with its own counters:
  /// consecutive points often fall into one cell, and would wait for each other at its counter.
  void sort(const std::vector<CellPoint>& places, const std::vector<std::uint16_t>& cells) {
    const std::size_t count = places.size();
    const std::size_t half = count / 2;
    std::array<std::uint32_t, kCellCount> first{}, second{};
    for (std::size_t i = 0; i < half; ++i) {
      ++first[cells[i]];
      ++second[cells[half + i]];
    }
    if (count % 2 != 0) ++second[cells[count - 1]];
    for (std::size_t cell = 0; cell < kCellCount; ++cell) {
      start_[cell + 1] = start_[cell] + first[cell] + second[cell];
      second[cell] = start_[cell] + first[cell];  // from now on the place of the next point
      first[cell] = start_[cell];
    }
    points_.resize(count);
    for (std::size_t i = 0; i < half; ++i) {
      points_[first[cells[i]]++] = places[i];
      points_[second[cells[half + i]]++] = places[half + i];
    }
    if (count % 2 != 0) points_[second[cells[count - 1]]] = places[count - 1];
  }

  std::array<std::uint32_t, kCellCount + 1> start_{};
  std::vector<CellPoint> points_;
};

/// The part of the surface inside the cell: a rectangle of the cell's face lifted to the surface, then clipped at the
/// cell's top and bottom (Sutherland, Hodgman 1974). Coordinates as in CellSurface.
void clipToCell(const CellSurface& surface, const SquareRectangle& part, int grid, Occluder& out) {
  std::array<glm::vec3, 8> polygon, clipped;
  std::size_t count = 4;
  const auto w = static_cast<glm::length_t>(surface.w);
  for (std::size_t i = 0; i < 4; ++i) {
    const int column = i == 1 || i == 2 ? part.right : part.left, row = i >= 2 ? part.bottom : part.top;
    const float atU = static_cast<float>(column) / static_cast<float>(grid) - 0.5f;
    const float atV = static_cast<float>(row) / static_cast<float>(grid) - 0.5f;
    polygon[i][static_cast<glm::length_t>(surface.u)] = atU;
    polygon[i][static_cast<glm::length_t>(surface.v)] = atV;
    polygon[i][w] = surface.height(atU, atV);
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

/// As many cells along an axis as leave a hundred points, roughly, for each cell that a surface crosses: three sides of
/// the cube cross 3 n² cells.
int cellsFor(std::uint32_t points) {
  int cells = kCells;
  while (cells > 4 && points < 80u * 3u * static_cast<std::uint32_t>(cells * cells)) cells /= 2;
  return cells;
}

std::size_t cellIndex(const glm::ivec3& cell) {
  return static_cast<std::size_t>((cell.x * kCells + cell.y) * kCells + cell.z);
}

glm::ivec3 cellAt(std::size_t cell) {
  return {static_cast<int>(cell / (kCells * kCells)), static_cast<int>(cell / kCells % kCells),
          static_cast<int>(cell % kCells)};
}

/// Finds the closed surfaces in a node's cells.
class Finder {
 public:
  Finder(const NodeData& node, const Box& cube, int cellsAlong, float layer)
      : points_(node, cube, cellsAlong), cellsAlong_(cellsAlong), layer_(layer) {}

  struct Found {
    std::size_t cell = 0;
    CellSurface surface;
    int grid = 0;
    SquareRectangle part;    ///< closed squares of the grid; beyond it when cells beside it were joined
    std::uint32_t seed = 0;  ///< the position in found_ of the surface that this one continues, or its own
  };

  std::vector<Found> find() {
    for (std::size_t cell = 0; cell < kCellCount; ++cell) {
      CellSurface surface;
      if (isCovered(cell) || points_.of(cell).size() < OccluderSet::kLeastPoints ||
          !fitSurface(points_.of(cell), surface))
        continue;
      const std::size_t first = found_.size();
      trySurface(cell, surface, static_cast<std::uint32_t>(first));
      spread(first);
    }
    return std::move(found_);
  }

 private:
  static bool crosses(const CellSurface& surface) {
    const glm::vec3 steep = glm::abs(surface.normal);
    return std::abs(surface.offset) < 0.5f * (steep.x + steep.y + steep.z);
  }

  /// Tries each surface in the cells beside its own. Where a wall meets the floor, or something stands before it, the
  /// points of a cell do not lie in one plane, but the wall's is known from the cell beside. A surface that is found
  /// spreads further, so that a wall is one plane in all its cells.
  void spread(std::size_t first) {
    for (std::size_t i = first; i < found_.size() && found_.size() < OccluderSet::kMost; ++i) {
      const glm::ivec3 cell = cellAt(found_[i].cell);
      for (glm::length_t axis = 0; axis < 3; ++axis)
        for (const int side : {-1, 1}) {
          glm::ivec3 beside = cell;
          beside[axis] += side;
          if (beside[axis] < 0 || beside[axis] >= cellsAlong_) continue;
          CellSurface surface = found_[i].surface;
          surface.offset -= surface.normal[axis] * static_cast<float>(side);
          if (crosses(surface) && !isKnown(cellIndex(beside), surface))
            trySurface(cellIndex(beside), surface, found_[i].seed);
        }
    }
  }

  /// True when a surface that is closed all over the cell has spread into it, so there is no need to fit one.
  bool isCovered(std::size_t cell) const {
    for (std::uint32_t at = first_[cell]; at != 0; at = next_[at - 1])
      if (found_[at - 1].part.area() == found_[at - 1].grid * found_[at - 1].grid) return true;
    return false;
  }

  /// True when the cell has enough surfaces, or one so like this that a second would tell nothing new.
  bool isKnown(std::size_t cell, const CellSurface& surface) const {
    std::size_t known = 0;
    for (std::uint32_t at = first_[cell]; at != 0; at = next_[at - 1]) {
      if (++known == kMostSpread) return true;
      const CellSurface& other = found_[at - 1].surface;
      if (std::abs(glm::dot(other.normal, surface.normal)) > 0.95f &&
          std::abs(std::abs(other.offset) - std::abs(surface.offset)) < 4.0f * layer_)
        return true;
    }
    return false;
  }

  void trySurface(std::size_t cell, CellSurface& surface, std::uint32_t seed) {
    const std::span<const CellPoint> points = points_.of(cell);
    if (points.size() < OccluderSet::kLeastPoints || found_.size() >= OccluderSet::kMost) return;
    markSquares(points, layer_, surface);
    std::array<ClosedSquares, 3> grids;
    for (std::size_t i = 0; i < grids.size(); ++i) {
      const int grid = kCellGrid >> i;
      grids[i] = ClosedSquares(surface, grid);
      if (grids[i].all()) return add({cell, surface, grid, {0, grid, 0, grid}, seed});
    }
    for (const ClosedSquares& squares : grids)
      if (addParts(cell, surface, squares, seed)) return;
  }

  /// Adds the largest closed rectangles of a cell that a door, a window or something before the wall leaves open. False
  /// when they are too small to be worth their time.
  bool addParts(std::size_t cell, const CellSurface& surface, const ClosedSquares& squares, std::uint32_t seed) {
    const int least = squares.side * squares.side / kLeastPart;
    if (squares.held < least) return false;
    SquareRows inner = squares.inner();
    std::size_t parts = 0;
    for (; parts < kMostParts && found_.size() < OccluderSet::kMost; ++parts) {
      const SquareRectangle part = largestRectangle(inner, squares.side, least);
      if (part.area() == 0) break;
      add({cell, surface, squares.side, part, seed});
      const std::uint32_t columns = (1u << part.right) - (1u << part.left);
      for (int row = part.top; row < part.bottom; ++row) {
        std::uint16_t& bits = inner[static_cast<std::size_t>(row)];
        bits = static_cast<std::uint16_t>(bits & ~columns);
      }
    }
    return parts > 0;
  }

  void add(const Found& found) {
    found_.push_back(found);
    next_.push_back(first_[found.cell]);
    first_[found.cell] = static_cast<std::uint32_t>(found_.size());
  }

  const PointsByCell points_;
  const int cellsAlong_;
  const float layer_;  ///< half the thickness of a layer in cells
  std::vector<Found> found_;
  // The surfaces of a cell as a linked list through found_, by position + 1; 0 ends it.
  std::array<std::uint32_t, kCellCount> first_{};
  std::vector<std::uint32_t> next_;
};

/// The octant of the node's cube that the cell lies in, as in NodeKey.
int octantOf(const glm::ivec3& cell, int cellsAlong) {
  const int half = cellsAlong / 2;
  return (cell.x >= half ? 4 : 0) + (cell.y >= half ? 2 : 0) + (cell.z >= half ? 1 : 0);
}

/// Joins wholly closed cells that lie side by side in one plane into rectangles, in place, so that a wall of 8 x 8
/// cells becomes one occluder. It is as coarse as its coarsest cell. Cells with points below them are not joined with
/// cells without. A rectangle grows along u first, then by whole rows along v.
void joinCells(std::vector<Finder::Found>& found, int cellsAlong, std::uint8_t childMask) {
  // The surfaces of each cell in order, as a linked list through `found`, by position + 1.
  std::array<std::uint32_t, kCellCount> firstOf{};
  std::vector<std::uint32_t> nextOf(found.size());
  for (std::size_t i = found.size(); i-- > 0;)
    nextOf[i] = std::exchange(firstOf[found[i].cell], static_cast<std::uint32_t>(i + 1));
  std::vector<bool> joined(found.size(), false);
  const auto open = [&](const glm::ivec3& cell) { return (childMask >> octantOf(cell, cellsAlong) & 1) != 0; };
  const auto isWhole = [](const Finder::Found& f) { return f.part.area() == f.grid * f.grid; };
  std::vector<std::uint32_t> taken;
  for (std::size_t i = 0; i < found.size(); ++i) {
    Finder::Found& first = found[i];
    if (joined[i] || !isWhole(first)) continue;
    const glm::ivec3 at = cellAt(first.cell);
    const auto u = static_cast<glm::length_t>(first.surface.u), v = static_cast<glm::length_t>(first.surface.v);
    // The surface that continues this one so many cells along u and v; found.size() if there is none.
    const auto other = [&](int alongU, int alongV) {
      glm::ivec3 cell = at;
      cell[u] += alongU;
      cell[v] += alongV;
      const float height = first.surface.height(static_cast<float>(alongU), static_cast<float>(alongV));
      const float slope = std::abs(first.surface.height(0.5f, 0.0f) - first.surface.height(0.0f, 0.0f)) +
                          std::abs(first.surface.height(0.0f, 0.5f) - first.surface.height(0.0f, 0.0f));
      if (cell[u] >= cellsAlong || cell[v] >= cellsAlong || cell[v] < 0 || std::abs(height) + slope > 0.5f)
        return found.size();
      for (std::uint32_t k = firstOf[cellIndex(cell)]; k != 0; k = nextOf[k - 1]) {
        const Finder::Found& f = found[k - 1];
        if (!joined[k - 1] && f.seed == first.seed && isWhole(f) && open(cell) == open(at))
          return static_cast<std::size_t>(k - 1);
      }
      return found.size();
    };
    if (other(0, 0) == found.size()) continue;
    int width = 1, height = 1, grid = first.grid;
    while (other(width, 0) < found.size()) grid = std::min(grid, found[other(width++, 0)].grid);
    for (bool whole = true; whole;) {
      taken.clear();
      for (int k = 0; k < width && whole; ++k) {
        const std::size_t next = other(k, height);
        whole = next < found.size();
        if (whole) taken.push_back(static_cast<std::uint32_t>(next));
      }
      if (!whole) break;
      for (const std::uint32_t k : taken) {
        joined[k] = true;
        grid = std::min(grid, found[k].grid);
      }
      ++height;
    }
    for (int k = 1; k < width; ++k) joined[other(k, 0)] = true;
    first.grid = grid;
    first.part = {0, width * grid, 0, height * grid};
    joined[i] = false;
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < found.size(); ++i)
    if (!joined[i]) found[kept++] = found[i];
  found.resize(kept);
}

}  // namespace

void findOccluders(const NodeData& node, const Box& cube, std::uint8_t childMask, OccluderSet& out) {
  out.occluders.clear();
  out.origin = cube.centre();
  const int cellsAlong = cellsFor(node.pointCount());
  const double side = cube.size().x / cellsAlong;
  out.cellSide = side;
  if (!(side > 0.0) || node.pointCount() < OccluderSet::kLeastPoints) return;
  double coarseness = 0.0;  // half a step of the positions used, in cells
  for (const Batch& batch : node.batches)
    for (glm::length_t axis = 0; axis < 3; ++axis)
      if (batch.bits[axis] > 10) coarseness = std::max(coarseness, batch.boxSize[axis] / 2048.0 / side);
  const float layer = kLayer + static_cast<float>(coarseness);
  const auto metres = static_cast<float>(side);
  std::vector<Finder::Found> all = Finder(node, cube, cellsAlong, layer).find();
  joinCells(all, cellsAlong, childMask);
  const std::size_t most = OccluderSet::mostOf(node.pointCount());
  out.occluders.reserve(std::min(all.size(), most));
  for (const Finder::Found& found : all) {
    if (out.occluders.size() == most) break;
    const CellSurface& surface = found.surface;
    Occluder occluder;
    clipToCell(surface, found.part, found.grid, occluder);
    if (occluder.corners < 3 || areaOf(occluder) < kLeastArea) continue;
    const glm::ivec3 at = cellAt(found.cell);
    const glm::vec3 centre = glm::vec3(at) + 0.5f - 0.5f * static_cast<float>(cellsAlong);
    for (std::size_t k = 0; k < occluder.corners; ++k) occluder.corner[k] = (occluder.corner[k] + centre) * metres;
    occluder.normal = surface.normal;
    occluder.offset = (surface.offset + glm::dot(surface.normal, centre)) * metres;
    const float square = metres / static_cast<float>(found.grid);
    occluder.gap = square / std::abs(surface.normal[static_cast<glm::length_t>(surface.w)]);
    occluder.back = layer * metres + 0.5f * occluder.gap;
    occluder.whole = (childMask >> octantOf(at, cellsAlong) & 1) == 0;
    out.occluders.push_back(occluder);
  }
}

}  // namespace strata
