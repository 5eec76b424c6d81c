#pragma once
#include <cstdint>

#include "core/draw_options.h"

namespace strata {

// Colours are packed as R | G<<8 | B<<16 | 255<<24.

/// Packs three channels, each 0 to 255.
std::uint32_t packColour(int red, int green, int blue);

/// The colour of a height, from dark violet to yellow with evenly rising lightness. `t` is clamped to [0, 1].
std::uint32_t elevationColour(double t);
/// The colour of an ASPRS standard class (LAS 1.4 R15, table 17); grey for the reserved ones.
std::uint32_t classificationColour(std::uint8_t classification);
/// The colour of an octree level. Neighbouring levels differ, and colours repeat after eight.
std::uint32_t levelColour(int level);

/// The colour of the first, second, ... return. Colours repeat after eight.
std::uint32_t returnColour(int returnNumber);
/// The colour of a normal in the form of packNormal().
std::uint32_t normalColour(std::uint32_t normal);
/// The colour of 1, 2 or 3 planes of ten bits: green, yellow, red.
std::uint32_t precisionColour(int planes);
/// The colour of a density, from blue over green to red. `t` is clamped to [0, 1].
std::uint32_t heatColour(double t);

/// The colour of points whose node lacks the attribute that is asked for.
std::uint32_t missingColour();

}  // namespace strata
