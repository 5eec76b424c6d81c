#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace strata {

/// The colour plane has three columns (column_codec.h): green, red - green and blue - green, each as the difference to
/// the point before it in stored order, modulo 256. A colour is R | G << 8 | B << 16; its highest byte is ignored.

/// Appends the plane of colours in stored order. `spare` is working memory.
void appendColours(std::span<const std::uint32_t> colours, std::vector<std::uint8_t>& spare,
                   std::vector<std::byte>& out);

/// Gives back the colours of a plane in stored order, with 255 in the highest byte.
class ColourDecoder {
 public:
  /// False when the bytes are no such plane. `spare` is working memory that must not change until the last read().
  bool open(std::span<const std::byte> stored, std::size_t count, std::vector<std::uint8_t>& spare);
  /// Fills `out` with the next colours.
  void read(std::span<std::uint32_t> out);

 private:
  const std::uint8_t* green_ = nullptr;
  const std::uint8_t* red_ = nullptr;
  const std::uint8_t* blue_ = nullptr;
  std::uint32_t last_ = 0;  ///< green, red - green and blue - green of the point before
};

/// The unit of the residual plane, which holds for each 16-bit colour value v, drawn as the 8-bit value c, the part
/// that c does not tell, modulo 2^16. Values from 8-bit sources are multiples of a unit u, and their residual (v - u *
/// c) / u is 0 when v = u * c.
enum class ResidualUnit : std::uint16_t {
  shifted = 0,     ///< any values; the residual is v - (c << colour shift)
  upper = 256,     ///< all values are multiples of 256
  repeated = 257,  ///< all values have equal bytes
};
/// The residual of one value, and the value of one residual. `shift` is the colour shift.
std::uint16_t residualOf(ResidualUnit unit, std::uint16_t value, std::uint32_t colour, int shift);
std::uint16_t valueOf(ResidualUnit unit, std::uint16_t residual, std::uint32_t colour, int shift);

}  // namespace strata
