#include "io/table/field.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"

namespace strata {

void FieldRange::add(double value) {
  if (!std::isfinite(value)) return;
  min = std::min(min, value);
  max = std::max(max, value);
}

void FieldRange::add(const FieldRange& other) {
  min = std::min(min, other.min);
  max = std::max(max, other.max);
}

AxisFields findAxes(std::span<const Field> fields) {
  AxisFields axes;
  for (std::size_t i = 0; i < fields.size(); ++i)
    for (int axis = 0; axis < 3; ++axis)
      if (axes.index[axis] < 0 && fields[i].count == 1 && fields[i].name.size() == 1 &&
          lowerCase(fields[i].name)[0] == "xyz"[axis])
        axes.index[axis] = static_cast<int>(i);
  return axes;
}

}  // namespace strata
