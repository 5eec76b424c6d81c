#include "converter/build/lod_colour.h"

#include <algorithm>
#include <cstring>

namespace strata {

DrawColour::DrawColour(const StoreInfo& info) : shift_(info.colourShift) {
  const auto offsetOf = [&](std::string_view name) {
    const int index = info.layout.find(name);
    return index < 0 ? -1 : static_cast<int>(info.layout.offset(static_cast<std::size_t>(index)));
  };
  rgb_ = offsetOf(attribute::kRgb);
  ownShift_ = offsetOf(attribute::kColourShift);
}

std::uint32_t DrawColour::of(const std::byte* record) const {
  std::uint16_t rgb[3];
  std::memcpy(rgb, record + rgb_, sizeof rgb);
  const int shift = ownShift_ < 0 ? shift_ : static_cast<int>(record[ownShift_]) & 15;
  std::uint32_t colour = 0;
  for (int c = 0; c < 3; ++c) colour |= std::min(static_cast<unsigned>(rgb[c]) >> shift, 255u) << (8 * c);
  return colour;
}

}  // namespace strata
