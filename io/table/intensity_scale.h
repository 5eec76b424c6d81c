#pragma once
#include "io/table/field.h"

namespace strata {

/// How intensities of any type become the 16-bit ones that are drawn: (value + shift) * scale, clamped to 0..65535.
struct IntensityScale {
  double shift = 0.0;
  double scale = 1.0;
};

/// Guesses the scale from the range of a file's intensities: 0..1 fills the 16 bits, 0..255 is multiplied by 257,
/// 0..65535 stays, -2048..2047 (PTS) becomes (value + 2048) * 16, and anything else is stretched from its range.
IntensityScale intensityScale(const FieldRange& range);

}  // namespace strata
