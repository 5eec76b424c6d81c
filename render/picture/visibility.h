#pragma once
#include <bit>
#include <cstdint>
#include <vector>

#include "core/picture.h"

namespace strata {

/// One pixel of a visibility buffer: bits of the depth, then the point's id. The smaller value is the one to see
/// (Schütz 2022, Listing 1).
using PackedPixel = std::uint64_t;

constexpr PackedPixel packPixel(std::uint32_t depthBits, std::uint32_t id) { return PackedPixel{depthBits} << 32 | id; }
inline constexpr PackedPixel kEmptyPixel = packPixel(0x7f800000u, Picture::kNoPoint);  // +inf, no point

constexpr std::uint32_t pixelId(PackedPixel pixel) { return static_cast<std::uint32_t>(pixel); }
constexpr float pixelDepth(PackedPixel pixel) { return std::bit_cast<float>(static_cast<std::uint32_t>(pixel >> 32)); }

/// Colours of the points near a pixel's front, for their mean. Holds 2^24 points. Two sums a word, the first named in
/// the lower half, so that a point takes two additions; in memory the words red, green, blue, count.
struct ColourSum {
  std::uint64_t redGreen = 0, blueCount = 0;

  std::uint32_t red() const { return static_cast<std::uint32_t>(redGreen); }
  std::uint32_t green() const { return static_cast<std::uint32_t>(redGreen >> 32); }
  std::uint32_t blue() const { return static_cast<std::uint32_t>(blueCount); }
  std::uint32_t count() const { return static_cast<std::uint32_t>(blueCount >> 32); }
};

/// What resolving works with, kept from frame to frame: fresh memory costs more than the work.
struct ResolveScratch {
  std::vector<PackedPixel> pixels;
  std::vector<std::uint32_t> colours, ids;
  std::vector<std::uint8_t> sizes;
  std::vector<float> depths;
};

/// Gives `pixels` this size, in large pages where the system has them: the pixels of a batch lie in many rows, each in
/// pages of its own. Empty pixels where the size changed; else nothing happens.
void resizePixels(std::vector<PackedPixel>& pixels, std::size_t count);

/// Row by row from the top.
struct VisibilityBuffer {
  int width = 0;
  int height = 0;
  std::vector<PackedPixel> pixels{};
  std::vector<ColourSum> sums{};        ///< Shading::highQuality: one a pixel; not read otherwise
  std::vector<std::uint32_t> counts{};  ///< ColourMode::overdraw: points that fell on each pixel; likewise
  ResolveScratch scratch{};
};

}  // namespace strata
