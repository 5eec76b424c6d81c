#include "render/picture/colour_map.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace strata {
namespace {

struct Colour {
  std::uint8_t red, green, blue;
};

constexpr std::array<Colour, 9> kElevation{{{52, 16, 92},
                                            {60, 52, 134},
                                            {50, 90, 148},
                                            {38, 124, 148},
                                            {34, 154, 138},
                                            {66, 184, 112},
                                            {134, 208, 78},
                                            {204, 222, 60},
                                            {252, 234, 90}}};

constexpr std::array<Colour, 19> kClasses{{{150, 150, 150},   // 0 created, never classified
                                           {185, 185, 185},   // 1 unclassified
                                           {166, 122, 76},    // 2 ground
                                           {156, 204, 101},   // 3 low vegetation
                                           {85, 170, 70},     // 4 medium vegetation
                                           {32, 120, 50},     // 5 high vegetation
                                           {224, 102, 72},    // 6 building
                                           {230, 40, 160},    // 7 low point (noise)
                                           {110, 110, 150},   // 8 reserved (once model key point)
                                           {60, 130, 220},    // 9 water
                                           {130, 90, 150},    // 10 rail
                                           {110, 110, 110},   // 11 road surface
                                           {110, 110, 150},   // 12 reserved (once overlap)
                                           {240, 220, 80},    // 13 wire, guard
                                           {250, 180, 40},    // 14 wire, conductor
                                           {90, 200, 200},    // 15 transmission tower
                                           {200, 230, 120},   // 16 wire-structure connector
                                           {190, 160, 200},   // 17 bridge deck
                                           {230, 40, 160}}};  // 18 high noise

constexpr std::array<Colour, 8> kLevels{{{230, 80, 70},
                                         {240, 160, 60},
                                         {235, 220, 90},
                                         {120, 200, 90},
                                         {70, 190, 180},
                                         {80, 130, 220},
                                         {150, 100, 210},
                                         {220, 120, 180}}};

constexpr std::array<Colour, 3> kPrecisions{{{90, 190, 90}, {240, 200, 60}, {225, 70, 60}}};

constexpr std::array<Colour, 5> kHeat{{{20, 40, 160}, {30, 170, 220}, {60, 200, 80}, {245, 215, 50}, {215, 30, 30}}};

std::uint32_t pack(Colour colour) { return packColour(colour.red, colour.green, colour.blue); }

template <std::size_t kSteps>
std::uint32_t between(const std::array<Colour, kSteps>& map, double t) {
  const double place = (t > 0.0 ? std::min(t, 1.0) : 0.0) * (kSteps - 1);
  const std::size_t below = std::min(static_cast<std::size_t>(place), kSteps - 2);
  const double fraction = place - static_cast<double>(below);
  const Colour a = map[below], b = map[below + 1];
  const auto mix = [&](int from, int to) { return static_cast<int>(std::lround(from + (to - from) * fraction)); };
  return packColour(mix(a.red, b.red), mix(a.green, b.green), mix(a.blue, b.blue));
}

}  // namespace

std::uint32_t packColour(int red, int green, int blue) {
  return static_cast<std::uint32_t>(red) | static_cast<std::uint32_t>(green) << 8 |
         static_cast<std::uint32_t>(blue) << 16 | 0xff000000u;
}

std::uint32_t elevationColour(double t) { return between(kElevation, t); }

std::uint32_t classificationColour(std::uint8_t classification) {
  return classification < kClasses.size() ? pack(kClasses[classification]) : missingColour();
}

std::uint32_t levelColour(int level) { return pack(kLevels[static_cast<std::size_t>(level) % kLevels.size()]); }

std::uint32_t returnColour(int returnNumber) {
  return pack(kLevels[static_cast<std::size_t>(std::max(returnNumber - 1, 0)) % kLevels.size()]);
}

std::uint32_t normalColour(std::uint32_t normal) {
  const auto channel = [normal](int shift) {
    const int value = static_cast<std::int8_t>(normal >> shift & 255u);
    return std::clamp((value + 127) * 255 / 254, 0, 255);
  };
  return normal == 0 ? missingColour() : packColour(channel(0), channel(8), channel(16));
}

std::uint32_t precisionColour(int planes) {
  return pack(kPrecisions[static_cast<std::size_t>(std::clamp(planes, 1, 3) - 1)]);
}

std::uint32_t heatColour(double t) { return between(kHeat, t); }

std::uint32_t missingColour() { return packColour(200, 200, 200); }

}  // namespace strata
