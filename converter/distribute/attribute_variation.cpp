#include "converter/distribute/attribute_variation.h"

#include <algorithm>
#include <cstring>

namespace strata {

void findVariation(const std::byte* records, std::size_t stride, std::size_t attributeBytes, std::size_t count,
                   AttributeVariation& out) {
  out.differs.assign(attributeBytes, 0);
  std::size_t from = 0;
  for (; from + 8 <= attributeBytes || (from < attributeBytes && attributeBytes >= 8); from += 8) {
    const std::size_t at = std::min(from, attributeBytes - 8);
    std::uint64_t first, differing = 0;
    std::memcpy(&first, records + at, 8);
    for (std::size_t i = 1; i < count; ++i) {
      std::uint64_t word;
      std::memcpy(&word, records + i * stride + at, 8);
      differing |= word ^ first;
    }
    for (std::size_t b = 0; b < 8; ++b) out.differs[at + b] |= static_cast<std::uint8_t>(differing >> (8 * b) & 255);
  }
  for (; from < attributeBytes; ++from)
    for (std::size_t i = 1; i < count; ++i)
      out.differs[from] |= static_cast<std::uint8_t>(records[i * stride + from] ^ records[from]);
}

}  // namespace strata
