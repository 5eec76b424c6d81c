#pragma once
#include <cstddef>
#include <cstdint>

#include "render/picture/visibility.h"

namespace strata {

// The inner loops of post_process.cpp over one row of pixels. They run on the best instruction set of the machine.

/// Sets to[x] to the smallest of from[x - size/2] to from[x + (size-1)/2], as far as they lie in the row.
void dilateRow(const PackedPixel* from, PackedPixel* to, std::size_t width, std::size_t size);

/// Sets to[x] to min(to[x], from[x]).
void lowerRow(const PackedPixel* from, PackedPixel* to, std::size_t width);

/// Sets to[x] to log2(depth[x]), where depths below 1e-30 count as 1e-30. Infinity stays.
void log2Row(const float* depth, float* to, std::size_t width);

/// The logarithms of the depths of a row of pixels, and of the rows `apart` pixels above and below.
struct EdlRows {
  const float *above, *here, *below;
  std::size_t width, apart;
};
/// Multiplies the colours of pixels [begin, end) by exp(-gain * s). For each pixel, s sums by how much its eight
/// neighbours lie in front of it; they are `apart` pixels away, or at the edge. A pixel whose logarithm is +inf stays.
void shadeRow(const EdlRows& rows, std::size_t begin, std::size_t end, float gain, std::uint32_t* colours);

}  // namespace strata
