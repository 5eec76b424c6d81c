#pragma once
#include "render/progressive/progressive_rasterizer.h"

namespace strata {

/// Times of the passes, fill and importance of the pool, and the settings (Rumpler 2019, 3.6), in a window of its own
/// at the bottom right. True when a setting was changed.
bool drawProgressivePanel(ProgressiveRasterizer& rasterizer);

}  // namespace strata
