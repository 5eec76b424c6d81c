#include "render/plan/picture_tiles.h"

#include <algorithm>
#include <cstddef>

namespace strata {

int marginOf(const DrawOptions& options) {
  const int largest = options.pointMetres > 0.0f ? DrawOptions::kLargestPoint
                                                 : std::clamp(options.pointSize, 1, DrawOptions::kLargestPoint);
  const int fill = options.gaze.on ? DrawOptions::kLargestFill : std::clamp(options.fill, 1, DrawOptions::kLargestFill);
  // Lighting looks one point's width away, at what was filled, out of what squares cover; one more for rounding.
  return (options.edl ? largest : 0) + fill / 2 + largest / 2 + 1;
}

View withMargin(const View& part, int margin) {
  const View whole = wholePicture(part);
  const int left = std::max(part.part.left - margin, 0), top = std::max(part.part.top - margin, 0);
  const int right = std::min(part.part.left + part.width + margin, whole.width);
  const int bottom = std::min(part.part.top + part.height + margin, whole.height);
  return partOfPicture(whole, left, top, right - left, bottom - top);
}

void copyPart(const Picture& frame, const View& drawn, const View& part, Image& image, int left, int top) {
  const int fromLeft = part.part.left - drawn.part.left, fromTop = part.part.top - drawn.part.top;
  for (int y = 0; y < part.height; ++y)
    std::copy_n(frame.colour.begin() + static_cast<std::ptrdiff_t>(fromTop + y) * frame.width + fromLeft, part.width,
                image.pixels.begin() + static_cast<std::ptrdiff_t>(top + y) * image.width + left);
}

}  // namespace strata
