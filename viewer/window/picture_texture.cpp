#include "viewer/window/picture_texture.h"

#include <algorithm>
#include <string>

#include "core/error.h"

namespace strata {
namespace {

// Values from the OpenGL registry.
constexpr unsigned kTexture2D = 0x0DE1;
constexpr unsigned kMagFilter = 0x2800, kMinFilter = 0x2801;
constexpr int kNearest = 0x2600;
constexpr int kRgba8 = 0x8058;
constexpr unsigned kRgba = 0x1908;
constexpr unsigned kUnsignedByte = 0x1401;
constexpr unsigned kUnpackAlignment = 0x0CF5, kPackAlignment = 0x0D05;

}  // namespace

PictureTexture::PictureTexture(GlContext::GetProc getProc) {
  const auto load = [getProc](auto& function, const char* name) {
    function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(getProc(name));
    if (function == nullptr) throw Error("OpenGL", std::string("function is missing, found no ") + name);
  };
  load(gl_.genTextures, "glGenTextures");
  load(gl_.deleteTextures, "glDeleteTextures");
  load(gl_.bindTexture, "glBindTexture");
  load(gl_.texParameteri, "glTexParameteri");
  load(gl_.texImage2D, "glTexImage2D");
  load(gl_.texSubImage2D, "glTexSubImage2D");
  load(gl_.pixelStorei, "glPixelStorei");
  load(gl_.readPixels, "glReadPixels");
  gl_.genTextures(1, &texture_);
  gl_.bindTexture(kTexture2D, texture_);
  gl_.texParameteri(kTexture2D, kMagFilter, kNearest);
  gl_.texParameteri(kTexture2D, kMinFilter, kNearest);
  gl_.bindTexture(kTexture2D, 0);
}

PictureTexture::~PictureTexture() { gl_.deleteTextures(1, &texture_); }

void PictureTexture::upload(const Picture& picture) {
  gl_.bindTexture(kTexture2D, texture_);
  gl_.pixelStorei(kUnpackAlignment, 4);
  if (picture.width != width_ || picture.height != height_)
    gl_.texImage2D(kTexture2D, 0, kRgba8, picture.width, picture.height, 0, kRgba, kUnsignedByte,
                   picture.colour.data());
  else
    gl_.texSubImage2D(kTexture2D, 0, 0, 0, picture.width, picture.height, kRgba, kUnsignedByte, picture.colour.data());
  width_ = picture.width;
  height_ = picture.height;
  gl_.bindTexture(kTexture2D, 0);
}

Image PictureTexture::readBackBuffer(int width, int height) const {
  Image image{width, height,
              std::vector<std::uint32_t>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height))};
  gl_.pixelStorei(kPackAlignment, 4);
  gl_.readPixels(0, 0, width, height, kRgba, kUnsignedByte, image.pixels.data());
  // OpenGL's first row is the lowest. The alpha of a back buffer means nothing.
  for (int y = 0; y < height / 2; ++y)
    std::swap_ranges(image.pixels.begin() + static_cast<std::ptrdiff_t>(y) * width,
                     image.pixels.begin() + static_cast<std::ptrdiff_t>(y + 1) * width,
                     image.pixels.begin() + static_cast<std::ptrdiff_t>(height - 1 - y) * width);
  for (std::uint32_t& pixel : image.pixels) pixel |= 0xff000000u;
  return image;
}

}  // namespace strata
