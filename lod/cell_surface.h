#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include <glm/glm.hpp>

namespace strata {

/// Squares along a cell's side at the finest; a row of them fills the bits of a SquareRows entry.
inline constexpr int kCellGrid = 16;
/// Rows of bits, one for each square of a grid.
using SquareRows = std::array<std::uint16_t, kCellGrid>;

/// The place of a point in its cell in 1/1024 of the cell's side: x | y << 10 | z << 20.
using CellPoint = std::uint32_t;

/// A plane in a cell, seen along its steepest axis as a height over the other two. Coordinates from the cell's
/// centre in sides of the cell.
struct CellSurface {
  glm::vec3 normal{0.0f};
  float offset = 0.0f;
  std::size_t u = 0, v = 1, w = 2;  ///< w is the axis that the normal is nearest to
  SquareRows squares{};             ///< rows of v, bits of u: points near the plane

  float height(float atU, float atV) const {
    return (offset - normal[static_cast<glm::length_t>(u)] * atU - normal[static_cast<glm::length_t>(v)] * atV) /
           normal[static_cast<glm::length_t>(w)];
  }
};

/// The plane through the points' mean across their smallest principal axis. False where there is none.
bool fitSurface(std::span<const CellPoint> points, CellSurface& surface);

/// Notes in which squares there are points within `layer` of the plane.
void markSquares(std::span<const CellPoint> points, float layer, CellSurface& surface);

/// The squares of a coarser grid, and whether each holds a point, or need not: the plane leaves the cell there.
struct ClosedSquares {
  SquareRows closed{};
  int side = kCellGrid;      ///< of the grid
  int needed = 0, held = 0;  ///< squares that the plane crosses inside the cell, and those of them with a point

  ClosedSquares() = default;
  ClosedSquares(const CellSurface& surface, int gridSide);
  bool all() const { return needed > 0 && held == needed; }
  /// Those that have none but closed ones around them (as far as the cell goes): a square with a point may lie half
  /// beyond the edge of the surface.
  SquareRows inner() const;
};

/// Part of a grid: columns [left, right), rows [top, bottom).
struct SquareRectangle {
  int left = 0, right = 0, top = 0, bottom = 0;
  int area() const { return (right - left) * (bottom - top); }
};

/// The largest rectangle of set squares in a grid of `side` rows, of more than `least` of them; empty if there is none.
SquareRectangle largestRectangle(const SquareRows& rows, int side, int least);

}  // namespace strata
