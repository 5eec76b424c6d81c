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

/// Decodes one component into `out`, in stored order, and moves `stored` on. False when the bytes do not fit.
template <class T>
bool takeComponent(std::span<const std::byte>& stored, std::vector<std::uint8_t>& spare, std::span<T> out);

extern template bool takeComponent(std::span<const std::byte>&, std::vector<std::uint8_t>&, std::span<std::uint8_t>);
extern template bool takeComponent(std::span<const std::byte>&, std::vector<std::uint8_t>&, std::span<std::uint16_t>);
extern template bool takeComponent(std::span<const std::byte>&, std::vector<std::uint8_t>&, std::span<std::uint32_t>);
extern template bool takeComponent(std::span<const std::byte>&, std::vector<std::uint8_t>&, std::span<std::uint64_t>);

}  // namespace strata
