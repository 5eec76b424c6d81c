#pragma once
#include <optional>

#include "core/box.h"
#include "core/draw_options.h"
#include "io/store/store.h"

namespace strata {

/// The colour mode that shows a store best: its colours if they vary, else its intensity if that varies, else the
/// elevation.
ColourMode bestColour(const StoreInfo& info);

/// The options for drawing a store: the colour mode, an intensity range from the 1st to the 99th percentile, and the
/// elevation range of `bounds`.
DrawOptions drawOptionsFor(const StoreInfo& info, const Box& bounds, std::optional<ColourMode> colour);

}  // namespace strata
