#pragma once
#include <bit>
#include <cstdint>
#include <vector>

#include "core/picture.h"

namespace strata {

/// One pixel of a visibility buffer: the bits of the depth in the upper half, the point's id in the lower. Of two
/// values the smaller one is seen (Schütz 2022, Listing 1).
using PackedPixel = std::uint64_t;

constexpr PackedPixel packPixel(std::uint32_t depthBits, std::uint32_t id) { return PackedPixel{depthBits} << 32 | id; }
inline constexpr PackedPixel kEmptyPixel = packPixel(0x7f800000u, Picture::kNoPoint);  // +inf, no point

constexpr std::uint32_t pixelId(PackedPixel pixel) { return static_cast<std::uint32_t>(pixel); }
constexpr float pixelDepth(PackedPixel pixel) { return std::bit_cast<float>(static_cast<std::uint32_t>(pixel >> 32)); }

/// Sums the colours of the points near a pixel's front, of up to 2^24 points. Each word holds two sums, the first named
/// one in its lower half, so that a point takes two additions. In memory this is four words: red, green, blue, count.
struct ColourSum {
  std::uint64_t redGreen = 0, blueCount = 0;

  std::uint32_t red() const { return static_cast<std::uint32_t>(redGreen); }
  std::uint32_t green() const { return static_cast<std::uint32_t>(redGreen >> 32); }
  std::uint32_t blue() const { return static_cast<std::uint32_t>(blueCount); }
  std::uint32_t count() const { return static_cast<std::uint32_t>(blueCount >> 32); }
};

/// Memory that resolving works in. It is kept from draw to draw, because fresh memory costs more than the work itself.
struct ResolveScratch {
  std::vector<PackedPixel> pixels;
  std::vector<std::uint32_t> colours, ids;
  std::vector<std::uint8_t> sizes;
  std::vector<float> depths;
};

/// Gives `pixels` the size `count` and empties them; nothing happens where they have this size already. They lie in
/// large pages where the system has them, because the pixels of a batch are spread over many rows and thereby over many
/// pages.
void resizePixels(std::vector<PackedPixel>& pixels, std::size_t count);

/// A picture before resolving: the point that each pixel shows. Row by row, row 0 on top.
struct VisibilityBuffer {
  int width = 0;
  int height = 0;
  std::vector<PackedPixel> pixels{};
  std::vector<ColourSum> sums{};        ///< one per pixel; only for Shading::highQuality
  std::vector<std::uint32_t> counts{};  ///< points that fell on each pixel; only for ColourMode::overdraw
  ResolveScratch scratch{};
};

}  // namespace strata
