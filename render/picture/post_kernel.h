#pragma once
#include <cstddef>
#include <cstdint>

#include "render/picture/visibility.h"

namespace strata {

// The inner loops of post_process.cpp over one row of pixels, by the best instruction set of the machine.

/// to[x] = the smallest of from[x - size/2] to from[x + (size-1)/2], as far as they are in the row.
void dilateRow(const PackedPixel* from, PackedPixel* to, std::size_t width, std::size_t size);

/// to[x] = min(to[x], from[x]).
void lowerRow(const PackedPixel* from, PackedPixel* to, std::size_t width);

/// log2 of each depth that is finite and at least 1e-30, else +inf or the log2 of that.
void log2Row(const float* depth, float* to, std::size_t width);

/// Logarithms of the depths of a row of pixels and of those `apart` pixels above and below.
struct EdlRows {
  const float *above, *here, *below;
  std::size_t width, apart;
};
/// Multiplies the colours of pixels [begin, end) by exp(-gain * s), s the sum of what their eight neighbours, `apart`
/// pixels away or at the edge, stand in front of them. A pixel whose logarithm is +inf stays.
void shadeRow(const EdlRows& rows, std::size_t begin, std::size_t end, float gain, std::uint32_t* colours);

}  // namespace strata
