#pragma once
#include <cstddef>
#include <type_traits>
#include <utility>

namespace strata {

/// Calls `run` with the size as a compile-time constant where it is at most kMost, so that copies of that size become
/// a few moves, and with the plain number otherwise. For loops over many records of one size.
template <std::size_t kMost, typename Run>
void withFixedSize(std::size_t size, Run&& run) {
  const auto tryAll = [&]<std::size_t... kSizes>(std::index_sequence<kSizes...>) {
    return ((size == kSizes && (run(std::integral_constant<std::size_t, kSizes>{}), true)) || ...);
  };
  if (!tryAll(std::make_index_sequence<kMost + 1>{})) run(size);
}

}  // namespace strata
