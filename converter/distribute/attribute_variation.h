#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace strata {

/// Tells which bytes of an attribute record differ between the points of a block.
struct AttributeVariation {
  std::vector<std::uint8_t> differs;  ///< by byte; 0 where all points have the same
};
/// Looks at `count` attribute records (at least one) of `attributeBytes` that lie `stride` bytes apart.
void findVariation(const std::byte* records, std::size_t stride, std::size_t attributeBytes, std::size_t count,
                   AttributeVariation& out);

}  // namespace strata
