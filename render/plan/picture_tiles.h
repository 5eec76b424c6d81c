#pragma once
#include <glm/vec2.hpp>

#include "core/draw_options.h"
#include "core/image.h"
#include "core/picture.h"
#include "core/view.h"

namespace strata {

// A picture too large to be drawn at once is drawn in tiles (PictureTile). Large points, hole filling and eye-dome
// lighting look beyond the edge of a tile. Each tile is therefore drawn with a margin, which is cut off afterwards; the
// rest equals the whole picture, pixel for pixel. Two things depend on the whole picture and cannot be drawn in tiles:
// overdraw, whose colours are relative to the largest count, and a view that exceeds its point budget.

/// How many pixels beyond a tile's edge its own pixels may depend on.
int tileMargin(const DrawOptions& options);

/// The view `tile` with `margin` pixels of its picture more on every side, as far as the picture goes.
View withMargin(const View& tile, int margin);

/// Copies the colours of `tile` out of `picture`, which was drawn from the view `drawn`, into `image` from the pixel
/// `to` on. Both views are tiles of one picture, and `tile` lies inside `drawn`.
void copyTile(const Picture& picture, const View& drawn, const View& tile, Image& image, const glm::ivec2& to);

}  // namespace strata
