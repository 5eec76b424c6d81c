#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/point_layout.h"

namespace strata {

/// One component of an attribute (or of the colour residual) over all points in stored order, as unsigned integers of
/// its width. Stored: u8 0 = the values, 1 = differences to the point before, sign in the lowest bit; then a column
/// (column_codec.h) for each byte of the width, the lowest first.

/// Appends `count` values of `width` 1, 2, 4 or 8 bytes that stand `stride` apart from `first` on, in the order of
/// `order` (empty: as they stand). `spare` is working memory.
struct ComponentSource {
  const std::byte* first;
  std::size_t stride;
  std::size_t width;
};
void appendComponent(const ComponentSource& source, std::span<const std::uint32_t> order, std::size_t count,
                     std::vector<std::uint8_t>& spare, std::vector<std::byte>& out);

/// Gives back one component in stored order. T: unsigned, of the component's width.
template <class T>
class ComponentDecoder {
 public:
  /// Moves `stored` behind the component. False when the bytes do not fit. `spare` is working memory, which has to stay
  /// as it is until all has been read.
  bool open(std::span<const std::byte>& stored, std::size_t count, std::vector<std::uint8_t>& spare);
  /// The next values.
  void read(std::span<T> out);

 private:
  const std::uint8_t* column_[sizeof(T)] = {};
  bool differences_ = false;
  T before_ = 0;
};

extern template class ComponentDecoder<std::uint8_t>;
extern template class ComponentDecoder<std::uint16_t>;
extern template class ComponentDecoder<std::uint32_t>;
extern template class ComponentDecoder<std::uint64_t>;

}  // namespace strata
