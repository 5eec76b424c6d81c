#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace strata {

/// The colour plane: three columns (column_codec.h) of green, red - green and blue - green, each as the difference to
/// the point before it in stored order, modulo 256. A colour is R | G << 8 | B << 16, the highest byte ignored.

void appendColours(std::span<const std::uint32_t> colours, std::vector<std::uint8_t>& spare,
                   std::vector<std::byte>& out);

/// Gives back the colours of a plane in stored order, with 255 in the highest byte.
class ColourDecoder {
 public:
  /// False when the bytes do not fit. `spare` is working memory, which has to stay as it is until all has been read.
  bool open(std::span<const std::byte> stored, std::size_t count, std::vector<std::uint8_t>& spare);
  /// The next colours.
  void read(std::span<std::uint32_t> out);

 private:
  const std::uint8_t* green_ = nullptr;
  const std::uint8_t* red_ = nullptr;
  const std::uint8_t* blue_ = nullptr;
  std::uint32_t last_ = 0;  ///< green and what red and blue have less
};

/// How the residual plane counts: what 8 bits leave of a 16-bit value v whose drawn colour is c, modulo 2^16.
/// The first two units hold what comes of 8-bit sources: (v - unit * c) / unit, which is 0 where v = unit * c.
enum class ResidualUnit : std::uint16_t {
  shifted = 0,     ///< v - (c << colour shift)
  upper = 256,     ///< all values are multiples of 256
  repeated = 257,  ///< all values have equal bytes
};
std::uint16_t residualOf(ResidualUnit unit, std::uint16_t value, std::uint32_t colour, int shift);
std::uint16_t valueOf(ResidualUnit unit, std::uint16_t residual, std::uint32_t colour, int shift);

}  // namespace strata
