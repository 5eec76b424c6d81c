#include "converter/normals/distinct_cells.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/random.h"

namespace strata {

DistinctCells::DistinctCells(int sizes) : registers_(static_cast<std::size_t>(sizes)) {
  for (auto& r : registers_) r.fill(0);
}

void DistinctCells::see(const std::int64_t (&grid)[3]) {
  for (std::size_t shift = 0; shift < registers_.size(); ++shift) {
    const auto x = static_cast<std::uint64_t>(grid[0] >> shift), y = static_cast<std::uint64_t>(grid[1] >> shift),
               z = static_cast<std::uint64_t>(grid[2] >> shift);
    const std::uint64_t hash = mix64(x * kSplitMixStep + mix64(y * 0xc2b2ae3d27d4eb4fu + mix64(z)));
    std::uint8_t& reg = registers_[shift][hash >> (64 - kIndexBits)];
    const std::uint64_t rest = hash << kIndexBits | std::uint64_t{1} << (kIndexBits - 1);
    reg = std::max(reg, static_cast<std::uint8_t>(std::countl_zero(rest) + 1));
  }
}

void DistinctCells::add(const DistinctCells& other) {
  for (std::size_t s = 0; s < registers_.size(); ++s)
    for (std::size_t i = 0; i < registers_[s].size(); ++i)
      registers_[s][i] = std::max(registers_[s][i], other.registers_[s][i]);
}

double DistinctCells::count(int shift) const {
  const auto& registers = registers_[static_cast<std::size_t>(shift)];
  const double m = static_cast<double>(registers.size());
  double sum = 0.0, empty = 0.0;
  for (const std::uint8_t r : registers) {
    sum += std::ldexp(1.0, -r);
    empty += r == 0 ? 1.0 : 0.0;
  }
  const double estimate = 0.7213 / (1.0 + 1.079 / m) * m * m / sum;
  return estimate <= 2.5 * m && empty > 0.0 ? m * std::log(m / empty) : estimate;
}

}  // namespace strata
