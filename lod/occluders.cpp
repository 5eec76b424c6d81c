#include "lod/occluders.h"

#include <algorithm>
#include <cmath>
#include <optional>
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

/// Joins wholly closed cells that lie side by side in one plane into rectangles, so that a wall of 8 x 8 cells becomes
/// one occluder. It is as coarse as its coarsest cell. Cells with points below them are not joined with cells without.
class Joiner {
 public:
  Joiner(std::vector<Finder::Found>& found, int cellsAlong, std::uint8_t childMask)
      : found_(found),
        cellsAlong_(cellsAlong),
        childMask_(childMask),
        next_(found.size()),
        joined_(found.size(), false) {
    for (std::size_t i = found.size(); i-- > 0;)
      next_[i] = std::exchange(first_[found[i].cell], static_cast<std::uint32_t>(i + 1));
  }

  /// Leaves one surface for each rectangle, and those that nothing continues.
  void join() {
    for (std::size_t i = 0; i < found_.size(); ++i)
      if (!joined_[i] && isWhole(found_[i]) && at(found_[i], 0, 0)) grow(found_[i]);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < found_.size(); ++i)
      if (!joined_[i]) found_[kept++] = found_[i];
    found_.resize(kept);
  }

 private:
  static bool isWhole(const Finder::Found& found) { return found.part.area() == found.grid * found.grid; }
  bool hasPointsBelow(const glm::ivec3& cell) const { return (childMask_ >> octantOf(cell, cellsAlong_) & 1) != 0; }

  /// The position of the surface that continues `first` so many cells along u and v, if there is one.
  std::optional<std::size_t> at(const Finder::Found& first, int alongU, int alongV) const {
    const CellSurface& surface = first.surface;
    const glm::ivec3 start = cellAt(first.cell);
    glm::ivec3 cell = start;
    int& u = cell[static_cast<glm::length_t>(surface.u)];
    int& v = cell[static_cast<glm::length_t>(surface.v)];
    u += alongU;
    v += alongV;
    // The surface has to stay in this layer of cells: it must not leave the cell through its top or bottom.
    const float height = surface.height(static_cast<float>(alongU), static_cast<float>(alongV));
    const float slope = std::abs(surface.height(0.5f, 0.0f) - surface.height(0.0f, 0.0f)) +
                        std::abs(surface.height(0.0f, 0.5f) - surface.height(0.0f, 0.0f));
    if (u >= cellsAlong_ || v >= cellsAlong_ || std::abs(height) + slope > 0.5f) return std::nullopt;
    for (std::uint32_t k = first_[cellIndex(cell)]; k != 0; k = next_[k - 1]) {
      const Finder::Found& other = found_[k - 1];
      if (!joined_[k - 1] && other.seed == first.seed && isWhole(other) &&
          hasPointsBelow(cell) == hasPointsBelow(start))
        return k - 1;
    }
    return std::nullopt;
  }

  /// Makes a rectangle out of a surface: along u as far as it goes, then by whole rows along v.
  void grow(Finder::Found& first) {
    taken_.clear();
    int width = 1, height = 1;
    for (; const std::optional<std::size_t> next = at(first, width, 0); ++width) taken_.push_back(*next);
    while (takeRow(first, width, height)) ++height;
    for (const std::size_t other : taken_) {
      joined_[other] = true;
      first.grid = std::min(first.grid, found_[other].grid);
    }
    first.part = {0, width * first.grid, 0, height * first.grid};
  }

  /// Takes a row of `width` cells, or nothing when not all of them continue `first`.
  bool takeRow(const Finder::Found& first, int width, int alongV) {
    const std::size_t before = taken_.size();
    for (int alongU = 0; alongU < width; ++alongU) {
      const std::optional<std::size_t> next = at(first, alongU, alongV);
      if (!next) {
        taken_.resize(before);
        return false;
      }
      taken_.push_back(*next);
    }
    return true;
  }

  // Constant after construction.
  std::vector<Finder::Found>& found_;
  const int cellsAlong_;
  const std::uint8_t childMask_;
  // The surfaces of a cell in order as a linked list through found_, by position + 1; 0 ends it.
  std::array<std::uint32_t, kCellCount> first_{};
  std::vector<std::uint32_t> next_;

  std::vector<bool> joined_;        ///< by position in found_: the surface has become a part of another
  std::vector<std::size_t> taken_;  ///< the other surfaces of the rectangle that grows
};

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
  Joiner(all, cellsAlong, childMask).join();
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
