#include "lod/cell_surface.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <numbers>

#include "core/instruction_sets.h"

namespace strata {
namespace {

/// Sums over points of x, y, z, xx, yy, zz, xy, xz, yz.
using Moments = std::array<std::uint64_t, 9>;

/// Adds a few points at a time, whose sums fit 32 bits: a vector register holds twice as many of those.
inline __attribute__((always_inline)) void addMoments(std::span<const CellPoint> points, Moments& moments) {
  constexpr std::size_t kAtOnce = 2048;
  for (; !points.empty(); points = points.subspan(std::min(points.size(), kAtOnce))) {
    std::uint32_t x = 0, y = 0, z = 0, xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;
    for (const CellPoint point : points.first(std::min(points.size(), kAtOnce))) {
      const std::uint32_t px = point & 1023u, py = point >> 10 & 1023u, pz = point >> 20;
      x += px, y += py, z += pz;
      xx += px * px, yy += py * py, zz += pz * pz;
      xy += px * py, xz += px * pz, yz += py * pz;
    }
    const std::uint32_t sums[] = {x, y, z, xx, yy, zz, xy, xz, yz};
    for (std::size_t k = 0; k < moments.size(); ++k) moments[k] += sums[k];
  }
}
void addMomentsPlain(std::span<const CellPoint> points, Moments& moments) { addMoments(points, moments); }
STRATA_TARGET_AVX2 void addMomentsAvx2(std::span<const CellPoint> points, Moments& moments) {
  addMoments(points, moments);
}

constexpr std::size_t kSquares = std::size_t{kCellGrid} * kCellGrid;
/// A byte for each square of the finest grid, and one that takes all points that are not near the surface.
using SquareBytes = std::array<std::uint8_t, kSquares + 8>;

/// Sets the bytes of squares that have points near the surface. The squares of many points are found first, with
/// vectors; the bytes are set one by one.
inline __attribute__((always_inline)) void markBytes(std::span<const CellPoint> points, float layer,
                                                     const CellSurface& surface, SquareBytes& bytes) {
  constexpr int kShift = std::countr_zero(1024u / kCellGrid);
  const glm::vec3 normal = surface.normal / 1024.0f;
  const float base = (0.5f - 512.0f) * (normal.x + normal.y + normal.z) - surface.offset;
  const int u = 10 * static_cast<int>(surface.u) + kShift, v = 10 * static_cast<int>(surface.v) + kShift;
  constexpr std::size_t kAtOnce = 256;
  std::array<std::uint32_t, kAtOnce> square;
  for (; !points.empty(); points = points.subspan(std::min(points.size(), kAtOnce))) {
    const std::size_t count = std::min(points.size(), kAtOnce);
    const CellPoint* const from = points.data();
    for (std::size_t i = 0; i < count; ++i) {
      const CellPoint p = from[i];
      const float distance = normal.x * static_cast<float>(static_cast<int>(p & 1023u)) +
                             normal.y * static_cast<float>(static_cast<int>(p >> 10 & 1023u)) +
                             normal.z * static_cast<float>(static_cast<int>(p >> 20)) + base;
      const std::uint32_t at = (p >> v & (kCellGrid - 1)) * kCellGrid + (p >> u & (kCellGrid - 1));
      square[i] = std::abs(distance) <= layer ? at : static_cast<std::uint32_t>(kSquares);
    }
    for (std::size_t i = 0; i < count; ++i) bytes[square[i]] = 1;
  }
}
void markBytesPlain(std::span<const CellPoint> points, float layer, const CellSurface& surface, SquareBytes& bytes) {
  markBytes(points, layer, surface, bytes);
}
STRATA_TARGET_AVX2 void markBytesAvx2(std::span<const CellPoint> points, float layer, const CellSurface& surface,
                                      SquareBytes& bytes) {
  markBytes(points, layer, surface, bytes);
}

/// The plain instruction set has no instruction for this.
int countBits(std::uint64_t bits) {
  bits -= bits >> 1 & 0x5555555555555555u;
  bits = (bits & 0x3333333333333333u) + (bits >> 2 & 0x3333333333333333u);
  bits = (bits + (bits >> 4)) & 0x0f0f0f0f0f0f0f0fu;
  return static_cast<int>(bits * 0x0101010101010101u >> 56);
}
int countBits(const SquareRows& rows) {
  std::array<std::uint64_t, sizeof(SquareRows) / 8> words;
  std::memcpy(words.data(), rows.data(), sizeof rows);
  int count = 0;
  for (const std::uint64_t word : words) count += countBits(word);
  return count;
}

/// Bit i of the result is bit 2 i or bit 2 i + 1 of the row.
std::uint32_t halved(std::uint32_t row) {
  row = (row | row >> 1) & 0x5555u;
  row = (row | row >> 1) & 0x3333u;
  row = (row | row >> 2) & 0x0f0fu;
  return (row | row >> 4) & 0x00ffu;
}

/// The eigenvector of the smallest eigenvalue λ of a symmetric matrix A (xx yy zz xy xz yz); zero when it is not
/// unique. The eigenvalues have a closed form (Smith 1961); the vector is the longest cross product of two rows of A -
/// λ.
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

void setNormal(const glm::vec3& normal, CellSurface& surface) {
  surface.normal = normal;
  const glm::vec3 steep = glm::abs(normal);
  surface.w = steep.x >= steep.y && steep.x >= steep.z ? 0 : steep.y >= steep.z ? 1 : 2;
  surface.u = (surface.w + 1) % 3;
  surface.v = (surface.w + 2) % 3;
}

}  // namespace

bool fitSurface(std::span<const CellPoint> points, CellSurface& surface) {
  Moments moments{};
  if (hasAvx2())
    addMomentsAvx2(points, moments);
  else
    addMomentsPlain(points, moments);
  std::array<double, 9> mean;
  for (std::size_t k = 0; k < mean.size(); ++k)
    mean[k] = static_cast<double>(moments[k]) / static_cast<double>(points.size());
  const auto spread = [&](std::size_t k, std::size_t i, std::size_t j) { return mean[k] - mean[i] * mean[j]; };
  setNormal(smallestAxis(
                {spread(3, 0, 0), spread(4, 1, 1), spread(5, 2, 2), spread(6, 0, 1), spread(7, 0, 2), spread(8, 1, 2)}),
            surface);
  surface.offset = glm::dot(surface.normal, (glm::vec3(mean[0], mean[1], mean[2]) + 0.5f) / 1024.0f - 0.5f);
  return std::abs(surface.normal[static_cast<glm::length_t>(surface.w)]) > 0.5f;
}

void markSquares(std::span<const CellPoint> points, float layer, CellSurface& surface) {
  SquareBytes bytes{};
  if (hasAvx2())
    markBytesAvx2(points, layer, surface, bytes);
  else
    markBytesPlain(points, layer, surface, bytes);
  for (std::size_t row = 0; row < kCellGrid; ++row) {
    std::uint64_t halves[2];
    std::memcpy(halves, bytes.data() + row * kCellGrid, sizeof halves);
    const auto bitsOf = [](std::uint64_t eight) { return static_cast<unsigned>(eight * 0x0102040810204080u >> 56); };
    surface.squares[row] = static_cast<std::uint16_t>(bitsOf(halves[0]) | bitsOf(halves[1]) << 8);
  }
}

ClosedSquares::ClosedSquares(const CellSurface& surface, int gridSide) : side(gridSide) {
  const int each = kCellGrid / side;
  const float size = 1.0f / static_cast<float>(side);
  // The surface's height over the middle of a square is linear in the square's column and row.
  const float alongU = -surface.normal[static_cast<glm::length_t>(surface.u)] /
                       surface.normal[static_cast<glm::length_t>(surface.w)] * size;
  const float alongV = -surface.normal[static_cast<glm::length_t>(surface.v)] /
                       surface.normal[static_cast<glm::length_t>(surface.w)] * size;
  const float first = surface.height(0.5f * size - 0.5f, 0.5f * size - 0.5f);
  const float inside = 0.5f - 0.5f * (std::abs(alongU) + std::abs(alongV));
  const std::uint32_t all = (1u << side) - 1;
  const bool isLevel = std::abs(alongU) < 1e-6f;
  const float perHeight = isLevel ? 0.0f : 1.0f / alongU;
  SquareRows withPoints{}, crossed{};
  for (int row = 0; row < side; ++row) {
    std::uint32_t points = 0;
    for (int i = 0; i < each; ++i) points |= surface.squares[static_cast<std::size_t>(row * each + i)];
    for (int columns = kCellGrid; columns > side; columns /= 2) points = halved(points);
    // The columns of this row in which the surface stays inside the cell.
    const float height = first + alongV * static_cast<float>(row);
    std::uint32_t in = 0;
    if (isLevel) {
      in = std::abs(height) <= inside ? all : 0;
    } else {
      const float a = (-inside - height) * perHeight, b = (inside - height) * perHeight;
      const float least = std::clamp(std::min(a, b), 0.0f, static_cast<float>(side));
      const int from = static_cast<int>(least) + (static_cast<float>(static_cast<int>(least)) < least ? 1 : 0);
      const int to = static_cast<int>(std::clamp(std::max(a, b) + 1.0f, 0.0f, static_cast<float>(side)));
      in = to > from ? (1u << to) - (1u << from) : 0;
    }
    const auto at = static_cast<std::size_t>(row);
    closed[at] = static_cast<std::uint16_t>(points | (all & ~in));
    crossed[at] = static_cast<std::uint16_t>(in);
    withPoints[at] = static_cast<std::uint16_t>(points & in);
  }
  needed = countBits(crossed);
  held = countBits(withPoints);
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
      if (countBits(common) * (side - top) <= bestArea) break;
      if (countBits(common) * (bottom - top) <= bestArea) continue;
      // The longest run of bits: each step takes one off every run, so the last bit left belongs to the longest.
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
