#pragma once
#include "core/draw_options.h"
#include "core/image.h"
#include "core/picture.h"
#include "core/view.h"

namespace strata {

// A picture too large for one frame is drawn in parts (PictureTile). Points wider than a pixel, hole filling and
// eye-dome lighting look beyond a part's edge, so each is drawn with a margin, which is then cut off: what is left is
// the whole picture's, pixel for pixel. Two ways of drawing go by the whole picture and cannot be parted: overdraw,
// whose colours are shares of the largest count, and a point budget that is reached.

/// Pixels beside a part that its own pixels may depend on.
int marginOf(const DrawOptions& options);

/// `part` with as much of its picture around it, as far as the picture goes.
View withMargin(const View& part, int margin);

/// The piece of `frame`, drawn from `drawn`, that `part` shows, into `image` at (left, top). Both views are of one
/// picture, and `part` lies in `drawn`.
void copyPart(const Picture& frame, const View& drawn, const View& part, Image& image, int left, int top);

}  // namespace strata
