#include "io/store/colour_codec.h"

#include <cstring>

#include "io/store/column_codec.h"

namespace strata {
namespace {

/// 257 * kInverse257 = 1 modulo 2^16.
constexpr std::uint32_t kInverse257 = 65281;
static_assert((257u * kInverse257 & 0xffffu) == 1);

using Words __attribute__((vector_size(16))) = std::uint32_t;
using Bytes __attribute__((vector_size(16))) = std::uint8_t;

/// Adds byte by byte, modulo 256.
Words addBytes(Words a, Words b) {
  return reinterpret_cast<Words>(reinterpret_cast<Bytes>(a) + reinterpret_cast<Bytes>(b));
}

/// Colours from red - green, green and blue - green in the three lower bytes.
Words coloursOf(Words differences) {
  const Words green = differences >> 8 & 255u;
  return addBytes(differences, green | green << 16) | 0xff000000u;
}

}  // namespace

void appendColours(std::span<const std::uint32_t> colours, std::vector<std::uint8_t>& spare,
                   std::vector<std::byte>& out) {
  const std::size_t count = colours.size();
  spare.resize(3 * count);
  std::uint8_t* const green = spare.data();
  std::uint8_t* const red = green + count;
  std::uint8_t* const blue = red + count;
  std::uint32_t g0 = 0, r0 = 0, b0 = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t g = colours[i] >> 8, r = colours[i] - g, b = (colours[i] >> 16) - g;
    green[i] = static_cast<std::uint8_t>(g - g0);
    red[i] = static_cast<std::uint8_t>(r - r0);
    blue[i] = static_cast<std::uint8_t>(b - b0);
    g0 = g;
    r0 = r;
    b0 = b;
  }
  for (std::size_t c = 0; c < 3; ++c) appendColumn(std::span(spare).subspan(c * count, count), out);
}

bool ColourDecoder::open(std::span<const std::byte> stored, std::size_t count, std::vector<std::uint8_t>& spare) {
  spare.resize(3 * count);
  for (std::size_t c = 0; c < 3; ++c)
    if (!takeColumn(stored, std::span(spare).subspan(c * count, count))) return false;
  green_ = spare.data();
  red_ = green_ + count;
  blue_ = red_ + count;
  last_ = 0;
  return stored.empty();
}

void ColourDecoder::read(std::span<std::uint32_t> out) {
  const std::size_t count = out.size();
  for (std::size_t i = 0; i < count; ++i)
    out[i] = static_cast<std::uint32_t>(red_[i]) | static_cast<std::uint32_t>(green_[i]) << 8 |
             static_cast<std::uint32_t>(blue_[i]) << 16;
  green_ += count;
  red_ += count;
  blue_ += count;
  // The differences are summed up four points at a time, all three channels of a point in one word.
  Words last{last_, last_, last_, last_};
  std::size_t i = 0;
  for (; i + 4 <= count; i += 4) {
    Words sums;
    std::memcpy(&sums, &out[i], sizeof sums);
    sums = addBytes(sums, __builtin_shufflevector(Words{}, sums, 0, 4, 5, 6));
    sums = addBytes(sums, __builtin_shufflevector(Words{}, sums, 0, 1, 4, 5));
    sums = addBytes(sums, last);
    last = __builtin_shufflevector(sums, sums, 3, 3, 3, 3);
    const Words colours = coloursOf(sums);
    std::memcpy(&out[i], &colours, sizeof colours);
  }
  for (; i < count; ++i) {
    last = addBytes(last, Words{out[i], 0, 0, 0});
    out[i] = coloursOf(last)[0];
  }
  last_ = last[0];
}

std::uint16_t residualOf(ResidualUnit unit, std::uint16_t value, std::uint32_t colour, int shift) {
  const std::uint32_t v = value;
  if (unit == ResidualUnit::repeated) return static_cast<std::uint16_t>((v - 257u * colour) * kInverse257);
  // The difference, a multiple of 256 modulo 2^16, is divided by 256 and sign-extended by hand.
  if (unit == ResidualUnit::upper) {
    const std::uint32_t difference = ((v >> 8) - colour) & 255u;
    return static_cast<std::uint16_t>(difference < 128 ? difference : difference | 0xff00u);
  }
  return static_cast<std::uint16_t>(v - (colour << shift));
}

std::uint16_t valueOf(ResidualUnit unit, std::uint16_t residual, std::uint32_t colour, int shift) {
  if (unit == ResidualUnit::repeated) return static_cast<std::uint16_t>(257u * (colour + residual));
  if (unit == ResidualUnit::upper) return static_cast<std::uint16_t>((colour + residual) << 8);
  return static_cast<std::uint16_t>((colour << shift) + residual);
}

}  // namespace strata
