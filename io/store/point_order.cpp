#include "io/store/point_order.h"

#include <algorithm>
#include <array>
#include <utility>

#include "io/store/position_codec.h"

namespace strata {
namespace {

constexpr int kDigitBits = 10;
constexpr int kKeyBits = 30;
constexpr int kKeyAt = 32;  // in a pair: key above, index below
/// Levels of fewer points are sorted by comparing.
constexpr std::size_t kLeastForRadix = 512;

void radixSort(std::span<std::uint64_t> pairs, std::span<std::uint64_t> spare) {
  constexpr std::size_t kDigits = std::size_t{1} << kDigitBits;
  constexpr int kRounds = kKeyBits / kDigitBits;
  std::array<std::array<std::uint32_t, kDigits>, kRounds> counts{};
  for (const std::uint64_t pair : pairs)
    for (std::size_t round = 0; round < kRounds; ++round)
      ++counts[round][pair >> (kKeyAt + static_cast<int>(round) * kDigitBits) & (kDigits - 1)];
  std::span<std::uint64_t> from = pairs, to = spare;
  for (std::size_t round = 0; round < kRounds; ++round) {
    const int shift = kKeyAt + static_cast<int>(round) * kDigitBits;
    std::array<std::uint32_t, kDigits>& starts = counts[round];
    if (starts[from[0] >> shift & (kDigits - 1)] == from.size()) continue;
    std::uint32_t start = 0;
    for (std::uint32_t& count : starts) start += std::exchange(count, start);
    for (const std::uint64_t pair : from) to[starts[pair >> shift & (kDigits - 1)]++] = pair;
    std::swap(from, to);
  }
  if (from.data() != pairs.data()) std::copy(from.begin(), from.end(), pairs.begin());
}

}  // namespace

void sortLevels(const NodePoints& points, const PayloadHead& head, std::span<const std::uint32_t> levelEnds,
                PointOrder& out) {
  const std::size_t count = points.count();
  out.pairs.resize(count);
  out.spare.resize(count);
  out.keys.resize(count);
  out.index.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    std::uint64_t offset[3];
    for (int axis = 0; axis < 3; ++axis)
      offset[axis] = static_cast<std::uint64_t>(points.grid[axis][i] - head.min[axis]);
    out.pairs[i] = static_cast<std::uint64_t>(octreeKey(head, offset)) << kKeyAt | i;
  }
  std::size_t first = 0;
  for (const std::uint32_t end : levelEnds) {
    const std::span<std::uint64_t> level = std::span(out.pairs).subspan(first, end - first);
    if (level.size() < kLeastForRadix)
      std::sort(level.begin(), level.end());
    else
      radixSort(level, std::span(out.spare).subspan(first, level.size()));
    first = end;
  }
  for (std::size_t i = 0; i < count; ++i) {
    out.keys[i] = static_cast<std::uint32_t>(out.pairs[i] >> kKeyAt);
    out.index[i] = static_cast<std::uint32_t>(out.pairs[i]);
  }
}

}  // namespace strata
