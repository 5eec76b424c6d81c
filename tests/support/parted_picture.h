#pragma once
#include <string>
#include <utility>
#include <vector>

#include "core/image.h"
#include "render/rasterizer.h"

namespace strata::test {

/// Every way to draw whose pixels depend on other pixels, and some that do not.
std::vector<std::pair<std::string, DrawOptions>> effectsOnPictures(const RenderList& list);

/// The picture of `view`, put together from parts of random sizes of at most 150 pixels a side, each drawn with
/// `margin`.
Image drawnInParts(Rasterizer& rasterizer, const RenderList& list, const View& view, const DrawOptions& options,
                   int margin, std::uint32_t seed);

/// Expects drawnInParts() to be what draw() gives, pixel for pixel, for all effects and views all around.
void expectPartsMakeTheWhole(Rasterizer& rasterizer, int views);

}  // namespace strata::test
