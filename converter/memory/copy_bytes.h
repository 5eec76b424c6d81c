#pragma once
#include <cstddef>
#include <cstring>

namespace strata {

/// memcpy for a record's few dozen bytes, without the call. The ranges must not overlap.
inline void copyBytes(std::byte* to, const std::byte* from, std::size_t count) {
  if (count < 8) {
    for (std::size_t i = 0; i < count; ++i) to[i] = from[i];
    return;
  }
  for (std::size_t i = 0; i + 8 < count; i += 8) std::memcpy(to + i, from + i, 8);
  std::memcpy(to + count - 8, from + count - 8, 8);
}

}  // namespace strata
