#include "render/picture/visibility.h"

#include <sys/mman.h>

namespace strata {
namespace {

constexpr std::size_t kHugePage = std::size_t{2} << 20;

}  // namespace

void resizePixels(std::vector<PackedPixel>& pixels, std::size_t count) {
  if (pixels.size() == count) return;
  pixels = {};
  pixels.reserve(count);
  const auto begin = (reinterpret_cast<std::uintptr_t>(pixels.data()) + kHugePage - 1) / kHugePage * kHugePage;
  const auto end = reinterpret_cast<std::uintptr_t>(pixels.data() + pixels.capacity()) / kHugePage * kHugePage;
  if (begin < end) madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
  pixels.resize(count, kEmptyPixel);
}

}  // namespace strata
