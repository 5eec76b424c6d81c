#include "io/table/intensity_scale.h"

#include <cmath>

namespace strata {

IntensityScale intensityScale(const FieldRange& range) {
  if (range.empty()) return {};
  if (range.min >= 0.0 && range.max <= 1.0) return {0.0, 65535.0};
  if (range.min >= 0.0 && range.max <= 255.0) return {0.0, 257.0};
  if (range.min >= 0.0 && range.max <= 65535.0) return {0.0, 1.0};
  if (range.min >= -2048.0 && range.max <= 2047.0) return {2048.0, 16.0};
  const double width = range.max - range.min;
  return {-range.min, width > 0.0 && std::isfinite(width) ? 65535.0 / width : 1.0};
}

}  // namespace strata
