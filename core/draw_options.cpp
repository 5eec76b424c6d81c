#include "core/draw_options.h"

namespace strata {

Shown shownBy(const DrawOptions& draw) {
  Shown shown{draw.colour, draw.jumpFlood, draw.clip};
  // Leaving out classes takes the classes as well. Return numbers and normals lie behind them in a payload, so whoever
  // reads those has the classes too.
  const bool isLate = draw.colour == ColourMode::returnNumber || draw.colour == ColourMode::normal;
  if (!draw.classes.all() && !isLate) shown.colour = std::nullopt;
  return shown;
}

}  // namespace strata
