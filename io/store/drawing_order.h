#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace strata {

/// The points of a level are stored in Morton order and drawn in 16 passes over that order, so that a prefix which ends
/// inside a level is even too. Pass i takes every sixteenth point from number kPasses[i] on, the middle of the widest
/// gap that the passes before it left.
inline constexpr std::array<std::uint32_t, 16> kPasses{0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15};

/// Takes the values of one level in stored order and puts each at its place in drawing order. T is unsigned, 1 to 8
/// bytes.
template <class T>
class LevelInterleaver {
 public:
  /// `drawn` has room for the `count` values of the level.
  LevelInterleaver(std::size_t count, T* drawn);
  /// Takes the next values: a multiple of 16 of them, except at the end of the level.
  void put(std::span<const T> stored);

 private:
  T* to_[kPasses.size()];  ///< for each place in a group of 16 where its next value goes
};

/// Values decoded at a time, few enough to be in the nearest cache still when they are put in order.
inline constexpr std::size_t kTileValues = 512;

/// Puts the values of all points of a node into drawing order. `read(first, out)` fills `out` with the values of the
/// points from `first` on in stored order, which are all of one level. Without levels the stored order is the drawing
/// order.
template <class T, class Read>
void toDrawingOrder(std::span<const std::uint32_t> levelEnds, std::span<T> drawn, Read&& read) {
  if (levelEnds.empty()) return read(std::size_t{0}, drawn);
  std::array<T, kTileValues> tile;
  std::size_t at = 0;
  for (const std::uint32_t end : levelEnds) {
    LevelInterleaver<T> interleaver(end - at, drawn.data() + at);
    while (at < end) {
      const std::span<T> values = std::span(tile).first(end - at < kTileValues ? end - at : kTileValues);
      read(at, values);
      interleaver.put(values);
      at += values.size();
    }
  }
}

extern template class LevelInterleaver<std::uint8_t>;
extern template class LevelInterleaver<std::uint16_t>;
extern template class LevelInterleaver<std::uint32_t>;
extern template class LevelInterleaver<std::uint64_t>;

}  // namespace strata
