#pragma once
#include "render/progressive/progressive_rasterizer.h"

namespace strata {

/// Draws the window "Progressive" at the bottom right: the settings of progressive drawing, how full the pool is, and
/// the time of each pass (Rumpler 2019, section 3.6). Between Window::beginFrame() and finishFrame(). True when a
/// setting was changed.
bool drawProgressivePanel(ProgressiveRasterizer& rasterizer);

}  // namespace strata
