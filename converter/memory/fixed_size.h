#pragma once
#include <cstddef>
#include <cstring>
#include <type_traits>
#include <utility>

namespace strata {

/// Calls `run` with the size as a compile-time constant where it is at most kMost, so that copies of that size become
/// a few moves; else with the plain number.
template <std::size_t kMost, typename Run>
void withFixedSize(std::size_t size, Run&& run) {
  const auto tryAll = [&]<std::size_t... kSizes>(std::index_sequence<kSizes...>) {
    return ((size == kSizes && (run(std::integral_constant<std::size_t, kSizes>{}), true)) || ...);
  };
  if (!tryAll(std::make_index_sequence<kMost + 1>{})) run(size);
}

/// memcpy of a few bytes, where the same sizes follow each other again and again: branches instead of a call.
[[gnu::always_inline]] inline void copyFew(std::byte* to, const std::byte* from, std::size_t bytes) {
  switch (bytes) {
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
    case 8:
      std::memcpy(to, from, 8);
      return;
    default:
      std::memcpy(to, from, bytes);
  }
}

}  // namespace strata
