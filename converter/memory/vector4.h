#pragma once
#include <cstdint>
#include <cstring>

namespace strata {

/// Four numbers at a time, by the compiler's own vector types: the same results with every instruction set.
using Float4 = float __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));
using Uint4 = std::uint32_t __attribute__((vector_size(16)));

inline Int4 loadInts(const std::int32_t* from) {
  Int4 v;
  std::memcpy(&v, from, sizeof v);
  return v;
}
inline Float4 toFloats(Int4 v) { return __builtin_convertvector(v, Float4); }

}  // namespace strata
