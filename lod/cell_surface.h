#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include <glm/glm.hpp>

namespace strata {

/// Squares along a cell's side at the finest; a row of them fills the bits of a SquareRows entry.
inline constexpr int kCellGrid = 16;
/// A bit for each square of a grid, row by row.
using SquareRows = std::array<std::uint16_t, kCellGrid>;

/// The place of a point in its cell, in 1/1024 of the cell's side: x | y << 10 | z << 20.
using CellPoint = std::uint32_t;

/// A plane fitted to the points of a cell, as a height along the axis w over the axes u and v. Coordinates are counted
/// from the cell's centre, in sides of the cell.
struct CellSurface {
  glm::vec3 normal{0.0f};
  float offset = 0.0f;
  std::size_t u = 0, v = 1, w = 2;  ///< w is the axis nearest to the normal
  SquareRows squares{};             ///< rows along v, bits along u: there are points near the plane

  float height(float atU, float atV) const {
    return (offset - normal[static_cast<glm::length_t>(u)] * atU - normal[static_cast<glm::length_t>(v)] * atV) /
           normal[static_cast<glm::length_t>(w)];
  }
};

/// Fits the plane through the mean of the points, across their smallest principal axis. False when they have no such
/// axis.
bool fitSurface(std::span<const CellPoint> points, CellSurface& surface);

/// Sets `surface.squares`: the squares with points within `layer` of the surface.
void markSquares(std::span<const CellPoint> points, float layer, CellSurface& surface);

/// The closed squares of a grid that may be coarser than CellSurface's: A square is closed when it holds a point near
/// the surface, or when the surface leaves the cell there, so that no point is needed.
struct ClosedSquares {
  SquareRows closed{};
  int side = kCellGrid;      ///< squares along the grid's side
  int needed = 0, held = 0;  ///< squares where the surface is inside the cell, and how many of them have a point

  ClosedSquares() = default;
  ClosedSquares(const CellSurface& surface, int gridSide);
  bool all() const { return needed > 0 && held == needed; }
  /// The closed squares that have only closed ones around them inside the cell. Others may lie half beyond the edge of
  /// the surface, although they hold a point.
  SquareRows inner() const;
};

/// A part of a grid: columns [left, right), rows [top, bottom).
struct SquareRectangle {
  int left = 0, right = 0, top = 0, bottom = 0;
  int area() const { return (right - left) * (bottom - top); }
};

/// The largest rectangle of set squares in a grid of `side` rows; empty unless it has more than `least` of them.
SquareRectangle largestRectangle(const SquareRows& rows, int side, int least);

}  // namespace strata
