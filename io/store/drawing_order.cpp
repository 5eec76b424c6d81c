#include "io/store/drawing_order.h"

#include <cstring>

namespace strata {
namespace {

constexpr std::size_t kGroup = kPasses.size();
constexpr std::size_t kVectorBytes = 16;

template <class T>
using Vector __attribute__((vector_size(kVectorBytes))) = T;

using Bytes = Vector<std::uint8_t>;
using Shorts = Vector<std::uint16_t>;
using Words = Vector<std::uint32_t>;
using Longs = Vector<std::uint64_t>;

/// The values of the lower or the upper halves of two vectors in turn.
Bytes lower(Bytes a, Bytes b) {
  return __builtin_shufflevector(a, b, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
}
Bytes upper(Bytes a, Bytes b) {
  return __builtin_shufflevector(a, b, 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31);
}
Shorts lower(Shorts a, Shorts b) { return __builtin_shufflevector(a, b, 0, 8, 1, 9, 2, 10, 3, 11); }
Shorts upper(Shorts a, Shorts b) { return __builtin_shufflevector(a, b, 4, 12, 5, 13, 6, 14, 7, 15); }
Words lower(Words a, Words b) { return __builtin_shufflevector(a, b, 0, 4, 1, 5); }
Words upper(Words a, Words b) { return __builtin_shufflevector(a, b, 2, 6, 3, 7); }
Longs lower(Longs a, Longs b) { return __builtin_shufflevector(a, b, 0, 2); }
Longs upper(Longs a, Longs b) { return __builtin_shufflevector(a, b, 1, 3); }

/// Transposes a square of values, whose rows are one vector long and `stride` values apart. Each round puts the vectors
/// of the first and of the second half in turn; after log2 of their number of rounds, rows and columns have changed
/// places.
template <class T>
void transpose(const T* from, std::size_t stride, T* const* to) {
  constexpr std::size_t kSide = kVectorBytes / sizeof(T);
  Vector<T> rows[kSide], next[kSide];
  for (std::size_t i = 0; i < kSide; ++i) std::memcpy(&rows[i], from + i * stride, kVectorBytes);
  for (std::size_t round = 1; round < kSide; round *= 2) {
    for (std::size_t i = 0; i < kSide / 2; ++i) {
      next[2 * i] = lower(rows[i], rows[i + kSide / 2]);
      next[2 * i + 1] = upper(rows[i], rows[i + kSide / 2]);
    }
    std::memcpy(rows, next, sizeof rows);
  }
  for (std::size_t i = 0; i < kSide; ++i) std::memcpy(to[i], &rows[i], kVectorBytes);
}

}  // namespace

template <class T>
LevelInterleaver<T>::LevelInterleaver(std::size_t count, T* drawn) {
  for (const std::size_t pass : kPasses) {
    to_[pass] = drawn;
    drawn += count > pass ? (count - pass + kGroup - 1) / kGroup : 0;
  }
}

template <class T>
void LevelInterleaver<T>::put(std::span<const T> stored) {
  constexpr std::size_t kSide = kVectorBytes / sizeof(T);
  const T* from = stored.data();
  std::size_t groups = stored.size() / kGroup;
  for (; groups >= kSide; groups -= kSide, from += kSide * kGroup)
    for (std::size_t k = 0; k < kGroup; k += kSide) {
      transpose(from + k, kGroup, to_ + k);
      for (std::size_t i = k; i < k + kSide; ++i) to_[i] += kSide;
    }
  for (; groups > 0; --groups, from += kGroup)
    for (std::size_t k = 0; k < kGroup; ++k) *to_[k]++ = from[k];
  for (std::size_t k = 0; k < stored.size() % kGroup; ++k) *to_[k]++ = from[k];
}

template class LevelInterleaver<std::uint8_t>;
template class LevelInterleaver<std::uint16_t>;
template class LevelInterleaver<std::uint32_t>;
template class LevelInterleaver<std::uint64_t>;

}  // namespace strata
