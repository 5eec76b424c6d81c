#include "render/plan/picture_tiles.h"

#include <algorithm>
#include <cstddef>

namespace strata {

int tileMargin(const DrawOptions& options) {
  const int largest = options.pointMetres > 0.0f ? DrawOptions::kLargestPoint
                                                 : std::clamp(options.pointSize, 1, DrawOptions::kLargestPoint);
  const int fill = options.gaze.on ? DrawOptions::kLargestFill : std::clamp(options.fill, 1, DrawOptions::kLargestFill);
  // Lighting looks one point's width away from pixels that may have been filled with pixels that a large point covers.
  // One more pixel is for rounding.
  return (options.edl ? largest : 0) + fill / 2 + largest / 2 + 1;
}

View withMargin(const View& tile, int margin) {
  const View whole = wholePicture(tile);
  const int left = std::max(tile.tile.left - margin, 0), top = std::max(tile.tile.top - margin, 0);
  const int right = std::min(tile.tile.left + tile.width + margin, whole.width);
  const int bottom = std::min(tile.tile.top + tile.height + margin, whole.height);
  return tileOfPicture(whole, left, top, right - left, bottom - top);
}

void copyTile(const Picture& picture, const View& drawn, const View& tile, Image& image, const glm::ivec2& to) {
  const int fromLeft = tile.tile.left - drawn.tile.left, fromTop = tile.tile.top - drawn.tile.top;
  for (int y = 0; y < tile.height; ++y)
    std::copy_n(picture.colour.begin() + static_cast<std::ptrdiff_t>(fromTop + y) * picture.width + fromLeft,
                tile.width, image.pixels.begin() + static_cast<std::ptrdiff_t>(to.y + y) * image.width + to.x);
}

}  // namespace strata
