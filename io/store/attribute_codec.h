#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/point_layout.h"

namespace strata {

/// The bytes of one component of an attribute, or of the colour residual, over all points in stored order. Values count
/// as unsigned integers of their width. Stored are a u8, 0 for the values themselves or 1 for differences to the point
/// before with the sign in the lowest bit, and then a column (column_codec.h) for each byte of the width, lowest first.

/// The values of a component in memory.
struct ComponentSource {
  const std::byte* first;                ///< value of point 0
  std::size_t stride;                    ///< bytes from the value of one point to that of the next
  std::size_t width;                     ///< bytes of a value: 1, 2, 4 or 8
  std::span<const std::uint32_t> order;  ///< points in stored order; empty when they are in it already
};
/// Appends `count` values. `spare` is working memory.
void appendComponent(const ComponentSource& source, std::size_t count, std::vector<std::uint8_t>& spare,
                     std::vector<std::byte>& out);

/// Gives back one component in stored order. T is unsigned and as wide as the component.
template <class T>
class ComponentDecoder {
 public:
  /// Takes the component off the front of `stored`. False when the bytes are no such component. `spare` is working
  /// memory that must not change until the last read().
  bool open(std::span<const std::byte>& stored, std::size_t count, std::vector<std::uint8_t>& spare);
  /// Fills `out` with the next values.
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
