#pragma once
#include <string>

namespace strata {

/// The size of a picture in pixels.
struct PictureSize {
  int width = 1920;
  int height = 1080;
};
/// Reads "1920x1080"; width and height are 1 to 16384 each. Throws UsageError.
PictureSize parseSize(const std::string& text);

}  // namespace strata
