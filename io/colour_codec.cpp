#include "io/colour_codec.h"

#include "io/column_codec.h"

namespace strata {
namespace {

/// 257 * kInverse257 = 1 modulo 2^16.
constexpr std::uint32_t kInverse257 = 65281;
static_assert((257u * kInverse257 & 0xffffu) == 1);

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

bool decodeColours(std::span<const std::byte> stored, std::vector<std::uint8_t>& spare, std::span<std::uint32_t> out) {
  const std::size_t count = out.size();
  spare.resize(3 * count);
  for (std::size_t c = 0; c < 3; ++c)
    if (!takeColumn(stored, std::span(spare).subspan(c * count, count))) return false;
  const std::uint8_t* const green = spare.data();
  const std::uint8_t* const red = green + count;
  const std::uint8_t* const blue = red + count;
  std::uint32_t g = 0, r = 0, b = 0;
  for (std::size_t i = 0; i < count; ++i) {
    g += green[i];
    r += red[i];
    b += blue[i];
    out[i] = ((r + g) & 255u) | (g & 255u) << 8 | ((b + g) & 255u) << 16 | 0xff000000u;
  }
  return stored.empty();
}

std::uint16_t residualOf(ResidualUnit unit, std::uint16_t value, std::uint32_t colour, int shift) {
  const std::uint32_t v = value;
  if (unit == ResidualUnit::repeated) return static_cast<std::uint16_t>((v - 257u * colour) * kInverse257);
  // Sign-extended by hand: a multiple of 256 modulo 2^16 divided by 256.
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
