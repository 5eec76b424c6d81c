#include "viewer/session/draw_defaults.h"

#include <algorithm>
#include <string_view>

namespace strata {
namespace {

std::optional<AttributeRange> rangeOf(const StoreInfo& info, std::string_view name) {
  const int index = info.layout.find(name);
  if (index < 0 || static_cast<std::size_t>(index) >= info.ranges.size()) return std::nullopt;
  return info.ranges[static_cast<std::size_t>(index)];
}

bool varies(const std::optional<AttributeRange>& range) { return range && range->max > range->min; }

}  // namespace

ColourMode bestColour(const StoreInfo& info) {
  if (varies(rangeOf(info, attribute::kRgb))) return ColourMode::rgb;
  if (varies(rangeOf(info, attribute::kIntensity))) return ColourMode::intensity;
  return ColourMode::elevation;
}

DrawOptions drawOptionsFor(const StoreInfo& info, const Box& bounds, std::optional<ColourMode> colour) {
  DrawOptions draw;
  draw.colour = colour.value_or(bestColour(info));
  if (const auto range = rangeOf(info, attribute::kIntensity)) {
    const bool gathered = range->high > range->low;
    draw.intensityRange = {static_cast<float>(gathered ? range->low : range->min),
                           static_cast<float>(gathered ? range->high : std::max(range->max, range->min + 1.0))};
  }
  if (!bounds.empty()) draw.elevationRange = {bounds.min.z, std::max(bounds.max.z, bounds.min.z + 1e-6)};
  return draw;
}

}  // namespace strata
