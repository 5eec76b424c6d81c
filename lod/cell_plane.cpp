#include "lod/cell_plane.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace strata {
namespace {

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

}  // namespace

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

void markSquares(std::span<const glm::u16vec3> points, float layer, CellPlane& plane) {
  const auto u = static_cast<glm::length_t>(plane.u), v = static_cast<glm::length_t>(plane.v);
  plane.squares.fill(0);
  constexpr int kShift = std::countr_zero(1024u / kCellGrid);
  for (const glm::u16vec3& point : points) {
    const bool near = std::abs(glm::dot(plane.normal, placeInCell(point)) - plane.offset) <= layer;
    std::uint16_t& row = plane.squares[point[v] >> kShift];
    row = static_cast<std::uint16_t>(row | static_cast<std::uint32_t>(near) << (point[u] >> kShift));
  }
}

ClosedSquares::ClosedSquares(const CellPlane& plane, int gridSide) : side(gridSide) {
  const int each = kCellGrid / side;
  const float size = 1.0f / static_cast<float>(side);
  const float slope = (std::abs(plane.normal[static_cast<glm::length_t>(plane.u)]) +
                       std::abs(plane.normal[static_cast<glm::length_t>(plane.v)])) /
                      std::abs(plane.normal[static_cast<glm::length_t>(plane.w)]);
  const float inside = 0.5f - 0.5f * size * slope;
  for (int row = 0; row < side; ++row) {
    std::uint32_t points = 0, hold = 0, out = 0;
    for (int i = 0; i < each; ++i) points |= plane.squares[static_cast<std::size_t>(row * each + i)];
    for (int column = 0; column < side; ++column) {
      const float height = plane.height((static_cast<float>(column) + 0.5f) * size - 0.5f,
                                        (static_cast<float>(row) + 0.5f) * size - 0.5f);
      const auto hasPoint = static_cast<std::uint32_t>((points >> (column * each) & ((1u << each) - 1)) != 0);
      const auto leaves = static_cast<std::uint32_t>(std::abs(height) > inside);
      hold |= hasPoint << column;
      out |= leaves << column;
    }
    const auto at = static_cast<std::size_t>(row);
    closed[at] = static_cast<std::uint16_t>(hold | out);
    needed += side - std::popcount(out);
    held += std::popcount(hold & ~out);
  }
}

SquareRows ClosedSquares::inner() const {
  SquareRows narrow{}, out{};
  const std::uint32_t last = 1u << (side - 1);
  const auto rows = static_cast<std::size_t>(side);
  for (std::size_t row = 0; row < rows; ++row) {
    const std::uint32_t bits = closed[row];
    narrow[row] = static_cast<std::uint16_t>(bits & (bits << 1 | 1u) & (bits >> 1 | last));
  }
  for (std::size_t row = 0; row < rows; ++row)
    out[row] = static_cast<std::uint16_t>(narrow[row] & narrow[row > 0 ? row - 1 : 0] &
                                          narrow[row + 1 < rows ? row + 1 : row]);
  return out;
}

SquareRectangle largestRectangle(const SquareRows& rows, int side, int least) {
  SquareRectangle best;
  int bestArea = least;
  for (int top = 0; top < side; ++top) {
    std::uint32_t common = 0xffffu;
    for (int bottom = top + 1; bottom <= side; ++bottom) {
      common &= rows[static_cast<std::size_t>(bottom - 1)];
      if (std::popcount(common) * (side - top) <= bestArea) break;
      if (std::popcount(common) * (bottom - top) <= bestArea) continue;
      // The longest run: thinned by one at its end until nothing is left.
      int length = 0, last = 0;
      for (std::uint32_t left = common; left != 0; left &= left << 1, ++length) last = std::countr_zero(left);
      if (length * (bottom - top) <= bestArea) continue;
      bestArea = length * (bottom - top);
      best = {last - length + 1, last + 1, top, bottom};
    }
  }
  return best;
}

}  // namespace strata
