#pragma once
#include <cstdint>

#include "core/draw_options.h"

namespace strata {

/// R | G<<8 | B<<16 | 255<<24.
std::uint32_t packColour(int red, int green, int blue);

/// Dark violet to yellow, its lightness rising evenly. `t` is clamped to [0, 1].
std::uint32_t elevationColour(double t);
/// Of the ASPRS standard classes (LAS 1.4 R15, table 17); grey for the reserved ones.
std::uint32_t classificationColour(std::uint8_t classification);
/// Tells neighbouring levels apart; repeats after eight.
std::uint32_t levelColour(int level);

/// First, second, ... return; repeats after eight.
std::uint32_t returnColour(int returnNumber);
/// Of packNormal()'s form.
std::uint32_t normalColour(std::uint32_t normal);
/// 1, 2 or 3 planes of ten bits: green, yellow, red.
std::uint32_t precisionColour(int planes);
/// Blue over green to red; `t` is clamped to [0, 1].
std::uint32_t heatColour(double t);

/// Where a node lacks the attribute that is asked for.
std::uint32_t missingColour();

}  // namespace strata
