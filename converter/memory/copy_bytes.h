#pragma once
#include <cstddef>
#include <cstring>

namespace strata {

/// memcpy for the few dozen bytes of a record or of a part of it, without the call. The ranges must not overlap.
[[gnu::always_inline]] inline void copyBytes(std::byte* to, const std::byte* from, std::size_t count) {
  if (count >= 8) {
    // The last eight bytes may overlap those before them.
    for (std::size_t i = 0; i + 8 < count; i += 8) std::memcpy(to + i, from + i, 8);
    std::memcpy(to + count - 8, from + count - 8, 8);
    return;
  }
  switch (count) {
    case 1:
      *to = *from;
      return;
    case 2:
      std::memcpy(to, from, 2);
      return;
    case 3:
      std::memcpy(to, from, 3);
      return;
    case 4:
      std::memcpy(to, from, 4);
      return;
    case 6:
      std::memcpy(to, from, 6);
      return;
    default:
      for (std::size_t i = 0; i < count; ++i) to[i] = from[i];
  }
}

}  // namespace strata
