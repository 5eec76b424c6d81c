#include "viewer/session/legend.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "render/picture/colour_map.h"
#include "viewer/session/class_census.h"

namespace strata {
namespace {

constexpr int kScaleColours = 32;
constexpr int kReturns = 5;
constexpr int kMostLevels = 21;

std::string number(double value, const char* format) {
  char text[48];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

template <typename ColourOf>
Legend scale(std::string low, std::string high, ColourOf colourOf) {
  Legend legend;
  for (int i = 0; i < kScaleColours; ++i) legend.colours.push_back(colourOf(i / (kScaleColours - 1.0)));
  legend.low = std::move(low);
  legend.high = std::move(high);
  return legend;
}

}  // namespace

Legend legendOf(const DrawOptions& options, const std::bitset<256>& classes, int levels) {
  Legend legend;
  switch (options.colour) {
    case ColourMode::rgb:
      break;
    case ColourMode::intensity:
      return scale(number(static_cast<double>(options.intensityRange.x), "%.0f"),
                   number(static_cast<double>(options.intensityRange.y), "%.0f"), [](double t) {
                     const int grey = static_cast<int>(std::lround(255.0 * t));
                     return packColour(grey, grey, grey);
                   });
    case ColourMode::elevation:
      return scale(number(options.elevationRange.x, "%.2f m"), number(options.elevationRange.y, "%.2f m"),
                   elevationColour);
    case ColourMode::overdraw:
      return scale("1 point", "most in a pixel", heatColour);
    case ColourMode::classification:
      for (std::size_t c = 0; c < classes.size(); ++c)
        if (classes[c]) {
          const auto code = static_cast<std::uint8_t>(c);
          legend.entries.push_back({classificationColour(code), std::to_string(c) + " " + className(code)});
        }
      break;
    case ColourMode::level:
      for (int level = 0; level < std::min(levels, kMostLevels); ++level)
        legend.entries.push_back({levelColour(level), "level " + std::to_string(level)});
      break;
    case ColourMode::returnNumber:
      for (int n = 1; n <= kReturns; ++n) legend.entries.push_back({returnColour(n), "return " + std::to_string(n)});
      break;
    case ColourMode::normal:
      legend.entries = {{packColour(255, 128, 128), "to the east (x)"},
                        {packColour(128, 255, 128), "to the north (y)"},
                        {packColour(128, 128, 255), "upwards (z)"}};
      break;
    case ColourMode::precision:
      for (int planes = 1; planes <= 3; ++planes)
        legend.entries.push_back({precisionColour(planes), std::to_string(10 * planes) + " bits"});
      break;
  }
  return legend;
}

}  // namespace strata
