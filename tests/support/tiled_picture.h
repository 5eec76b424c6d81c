#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/image.h"
#include "render/rasterizer.h"

namespace strata::test {

/// Options, with their names, for every effect whose pixels depend on other pixels, and for some without one.
std::vector<std::pair<std::string, DrawOptions>> effectsOnPictures(const RenderList& list);

/// How a picture is cut into tiles of random sizes, of at most 150 pixels a side.
struct TileCuts {
  int margin = 0;  ///< pixels that are drawn beyond every side of a tile, and cut off
  std::uint32_t seed = 1;
};

/// The picture of `view`, put together from tiles.
Image drawnInTiles(Rasterizer& rasterizer, const RenderList& list, const View& view, const DrawOptions& options,
                   const TileCuts& cuts);

/// Expects drawnInTiles() to give the picture of draw(), pixel for pixel, with every effect and from `views` views all
/// around.
void expectTilesMakeTheWhole(Rasterizer& rasterizer, int views);

}  // namespace strata::test
