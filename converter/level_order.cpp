#include "converter/level_order.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "io/store.h"

namespace strata {
namespace {

constexpr std::uint8_t kUnplaced = 0xff;
/// Order of the passes over a level: each new one falls in the middle of the widest gap.
constexpr std::array<std::size_t, 16> kPasses{0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15};

/// Takes every third bit: the inverse of spreadBits.
std::int64_t compactBits(std::uint64_t v) {
  v &= 0x1249249249249249;
  v = (v | v >> 2) & 0x10c30c30c30c30c3;
  v = (v | v >> 4) & 0x100f00f00f00f00f;
  v = (v | v >> 8) & 0x001f0000ff0000ff;
  v = (v | v >> 16) & 0x001f00000000ffff;
  v = (v | v >> 32) & 0x1fffff;
  return static_cast<std::int64_t>(v);
}

/// Squared distance to the centre of the cell that the lowest `cellLevels` triples of the key address, in key units.
double distanceToCentre(std::uint64_t key, int cellLevels) {
  const std::uint64_t inside = key & ((std::uint64_t{1} << (3 * cellLevels)) - 1);
  const double centre = 0.5 * static_cast<double>((std::uint64_t{1} << cellLevels) - 1);
  const double x = static_cast<double>(compactBits(inside >> 2)) - centre;
  const double y = static_cast<double>(compactBits(inside >> 1)) - centre;
  const double z = static_cast<double>(compactBits(inside)) - centre;
  return x * x + y * y + z * z;
}

/// End of the run of points that share the cell of point `first`.
std::size_t cellEnd(const SortedKeys& points, std::size_t first, int shift) {
  const std::uint64_t cell = points.keys[first] >> shift;
  std::size_t end = first + 1;
  while (end < points.keys.size() && points.keys[end] >> shift == cell) ++end;
  return end;
}

std::uint32_t nearestToCentre(const SortedKeys& points, std::size_t first, std::size_t end, int cellLevels) {
  std::size_t best = first;
  if (end - first > 1) {
    double bestDistance = distanceToCentre(points.keys[first], cellLevels);
    for (std::size_t i = first + 1; i < end; ++i) {
      const double distance = distanceToCentre(points.keys[i], cellLevels);
      if (distance < bestDistance) {
        bestDistance = distance;
        best = i;
      }
    }
  }
  return static_cast<std::uint32_t>(best);
}

/// The finest level whose cells do not exceed `most`.
int finestLevel(const std::vector<std::uint32_t>& cells, std::size_t most) {
  int level = 0;
  while (level + 1 < static_cast<int>(cells.size()) && cells[static_cast<std::size_t>(level) + 1] <= most) ++level;
  return level;
}

void appendInterleaved(const std::vector<std::uint32_t>& level, std::vector<std::uint32_t>& order) {
  for (const std::size_t pass : kPasses)
    for (std::size_t i = pass; i < level.size(); i += kPasses.size()) order.push_back(level[i]);
}

}  // namespace

std::vector<std::uint32_t> occupiedCells(const SortedKeys& points) {
  std::vector<std::uint32_t> cells(static_cast<std::size_t>(points.levels) + 1, 0);
  if (points.keys.empty()) return cells;
  cells[0] = 1;
  for (std::size_t i = 1; i < points.keys.size(); ++i)
    if (const std::uint64_t different = points.keys[i] ^ points.keys[i - 1]; different != 0)
      ++cells[static_cast<std::size_t>(points.levels - (63 - std::countl_zero(different)) / 3)];
  for (std::size_t l = 1; l < cells.size(); ++l) cells[l] += cells[l - 1];
  return cells;
}

std::vector<std::uint32_t> selectRepresentatives(const SortedKeys& points, std::size_t capacity) {
  const std::vector<std::uint32_t> cells = occupiedCells(points);
  const int level = finestLevel(cells, capacity);
  const int cellLevels = points.levels - level;
  const bool finer = level < points.levels;
  const std::size_t full = cells[static_cast<std::size_t>(level)];
  // Cells of the next level that hold no representative of this one, and how many of them still fit.
  const std::size_t vacant = finer ? cells[static_cast<std::size_t>(level) + 1] - full : 0;
  const std::size_t wanted = std::min(vacant, capacity > full ? capacity - full : 0);
  std::vector<std::uint32_t> kept;
  kept.reserve(full + wanted);
  std::size_t share = 0;  // reaches `vacant` every vacant / wanted cells
  for (std::size_t first = 0; first < points.keys.size();) {
    const std::size_t end = cellEnd(points, first, 3 * cellLevels);
    const std::uint32_t representative = nearestToCentre(points, first, end, cellLevels);
    kept.push_back(representative);
    if (wanted > 0 && end - first > 1) {
      const int fineShift = 3 * (cellLevels - 1);
      const std::uint64_t taken = points.keys[representative] >> fineShift;
      for (std::size_t fine = first; fine < end;) {
        const std::size_t fineEnd = std::min(end, cellEnd(points, fine, fineShift));
        if (points.keys[fine] >> fineShift != taken && (share += wanted) >= vacant) {
          share -= vacant;
          kept.push_back(nearestToCentre(points, fine, fineEnd, cellLevels - 1));
        }
        fine = fineEnd;
      }
    }
    first = end;
  }
  std::sort(kept.begin(), kept.end());
  return kept;
}

LevelOrder levelOrder(const SortedKeys& points) {
  const std::size_t count = points.keys.size();
  const std::vector<std::uint32_t> cells = occupiedCells(points);
  LevelOrder out;
  out.order.reserve(count);
  std::vector<std::uint8_t> placedAt(count, kUnplaced);
  std::vector<std::uint32_t> inLevel;
  const int lastLevel = std::min(points.levels, NodeRecord::kMaxPrefixes - 2);
  for (int level = 0; level <= lastLevel && out.order.size() < count; ++level) {
    const int shift = 3 * (points.levels - level);
    inLevel.clear();
    for (std::size_t first = 0; first < count;) {
      const std::size_t end = cellEnd(points, first, shift);
      const auto isPlaced = [](std::uint8_t l) { return l != kUnplaced; };
      if (std::none_of(placedAt.begin() + static_cast<std::ptrdiff_t>(first),
                       placedAt.begin() + static_cast<std::ptrdiff_t>(end), isPlaced)) {
        const std::uint32_t chosen = nearestToCentre(points, first, end, points.levels - level);
        placedAt[chosen] = static_cast<std::uint8_t>(level);
        inLevel.push_back(chosen);
      }
      first = end;
    }
    appendInterleaved(inLevel, out.order);
    out.prefix.push_back(static_cast<std::uint32_t>(out.order.size()));
  }
  if (out.order.size() < count || out.prefix.empty()) {
    inLevel.clear();
    for (std::size_t i = 0; i < count; ++i)
      if (placedAt[i] == kUnplaced) inLevel.push_back(static_cast<std::uint32_t>(i));
    appendInterleaved(inLevel, out.order);
    out.prefix.push_back(static_cast<std::uint32_t>(count));
  }
  if (count > 0) {
    const int level = finestLevel(cells, count / 2);
    out.spacing = std::ldexp(1.0, -level) *
                  std::sqrt(static_cast<double>(cells[static_cast<std::size_t>(level)]) / static_cast<double>(count));
  }
  return out;
}

}  // namespace strata
