#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace strata {

/// Which bytes of an attribute record differ between the points of a block: 0 where they are all the same.
struct AttributeVariation {
  std::vector<std::uint8_t> differs;
};
/// `records`: `count` attribute records (at least one), `stride` bytes apart, of `attributeBytes`.
void findVariation(const std::byte* records, std::size_t stride, std::size_t attributeBytes, std::size_t count,
                   AttributeVariation& out);

}  // namespace strata
