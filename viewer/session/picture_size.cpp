#include "viewer/session/picture_size.h"

#include <cstdio>

#include "core/error.h"

namespace strata {

constexpr int kLargestSide = 16384;

PictureSize parseSize(const std::string& text) {
  PictureSize size;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%dx%d%c", &size.width, &size.height, &rest) != 2 || size.width < 1 ||
      size.height < 1 || size.width > kLargestSide || size.height > kLargestSide)
    throw UsageError("--size", "found " + text + " (expected WIDTHxHEIGHT, 1 to 16384 each)");
  return size;
}

}  // namespace strata
