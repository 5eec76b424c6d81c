#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace strata {

/// The points of a level stand in Morton order; drawn, they come in 16 passes over that order, so that a prefix which
/// ends inside a level is even too. Each pass falls in the middle of the widest gap that the ones before have left.
inline constexpr std::array<std::uint32_t, 16> kPasses{0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15};

/// Takes the values of one level in stored order and puts them where they are drawn. T: unsigned, 1 to 8 bytes.
template <class T>
class LevelInterleaver {
 public:
  /// `drawn` is where the level's values begin.
  LevelInterleaver(std::size_t count, T* drawn);
  /// The next values; a multiple of 16, but for the level's last.
  void put(std::span<const T> stored);

 private:
  T* to_[kPasses.size()];  ///< by place in a group of 16
};

/// So many values are decoded at a time, so that they are still in the nearest cache when they are put in order.
inline constexpr std::size_t kTileValues = 512;

/// Values of all points of a node into drawing order. `read(first, out)` gives the next ones in stored order, none of
/// two levels at once. Without levels they are drawn as they are stored.
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
