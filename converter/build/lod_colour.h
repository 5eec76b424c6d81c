#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "io/store/store.h"

namespace strata {

/// The points that a kept point represents.
struct Represented {
  std::uint32_t colour = 0;  ///< their mean, R | G << 8 | B << 16
  std::uint32_t points = 1;  ///< their number, the point itself included
};

/// Finds the colour that points are drawn in.
class DrawColour {
 public:
  explicit DrawColour(const StoreInfo& info);
  bool exists() const { return rgb_ >= 0; }
  /// The colour of an attribute record, R | G << 8 | B << 16.
  std::uint32_t of(const std::byte* record) const;

 private:
  int rgb_, ownShift_;  ///< offsets in an attribute record; -1 = it has none
  int shift_;           ///< of all points, where they have none of their own
};

/// The weighted means for `kept` points: `of(i)` is the Represented of point i, and `by[i]` the kept point that
/// represents it.
template <typename Of>
std::vector<Represented> averaged(std::span<const std::uint32_t> by, std::size_t kept, Of&& of) {
  struct Sum {
    std::uint64_t channel[3] = {0, 0, 0}, points = 0;
  };
  std::vector<Sum> sums(kept);
  for (std::size_t i = 0; i < by.size(); ++i) {
    const Represented one = of(i);
    Sum& sum = sums[by[i]];
    for (int c = 0; c < 3; ++c) sum.channel[c] += std::uint64_t{one.colour >> (8 * c) & 255u} * one.points;
    sum.points += one.points;
  }
  std::vector<Represented> out(kept);
  for (std::size_t k = 0; k < kept; ++k) {
    const std::uint64_t points = std::max<std::uint64_t>(sums[k].points, 1);
    for (int c = 0; c < 3; ++c)
      out[k].colour |= static_cast<std::uint32_t>((sums[k].channel[c] + points / 2) / points) << (8 * c);
    out[k].points = static_cast<std::uint32_t>(std::min<std::uint64_t>(points, 0xffffffffu));
  }
  return out;
}

}  // namespace strata
