#pragma once
#include <string>
#include <utility>
#include <vector>

#include "core/image.h"
#include "render/rasterizer.h"

namespace strata::test {

/// Options, with their names, for every effect whose pixels depend on other pixels, and for some without one.
std::vector<std::pair<std::string, DrawOptions>> effectsOnPictures(const RenderList& list);

/// The picture of `view`, put together from tiles of random sizes of at most 150 pixels a side, each drawn with
/// `margin` pixels more on every side.
Image drawnInTiles(Rasterizer& rasterizer, const RenderList& list, const View& view, const DrawOptions& options,
                   int margin, std::uint32_t seed);

/// Expects drawnInTiles() to give the picture of draw(), pixel for pixel, with every effect and from `views` views all
/// around.
void expectTilesMakeTheWhole(Rasterizer& rasterizer, int views);

}  // namespace strata::test
