#include "render/picture/visibility.h"

#include "render/large_pages.h"

namespace strata {

void resizePixels(std::vector<PackedPixel>& pixels, std::size_t count) {
  if (pixels.size() == count) return;
  pixels = {};
  pixels.reserve(count);
  adviseLargePages(pixels.data(), pixels.capacity() * sizeof(PackedPixel));
  pixels.resize(count, kEmptyPixel);
}

}  // namespace strata
