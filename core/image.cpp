#include "core/image.h"

#include <png.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "core/error.h"

namespace strata {
namespace {

png_image describe(int width, int height) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(width);
  png.height = static_cast<png_uint_32>(height);
  png.format = PNG_FORMAT_RGBA;
  return png;
}

}  // namespace

std::vector<std::uint8_t> encodePng(const Image& image) {
  png_image png = describe(image.width, image.height);
  png_alloc_size_t bytes = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::vector<std::uint8_t> out(bytes);
  if (!png_image_write_to_memory(&png, out.data(), &bytes, 0, image.pixels.data(), 0, nullptr))
    throw Error(std::string("encoding a PNG: ") + png.message);
  out.resize(bytes);
  return out;
}

void writePng(const std::string& path, const Image& image) {
  const std::vector<std::uint8_t> bytes = encodePng(image);
  std::FILE* file = std::fopen(path.c_str(), "wb");
  if (file == nullptr) throw posixError(path, "creating", errno);
  const bool written = std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
  const int writeError = errno;
  const bool closed = std::fclose(file) == 0;
  if (!written || !closed) throw posixError(path, "writing", written ? errno : writeError);
}

Image readPng(const std::string& path) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_file(&png, path.c_str()))
    throw Error(path, std::string("reading PNG: ") + png.message);
  png.format = PNG_FORMAT_RGBA;
  Image image{static_cast<int>(png.width), static_cast<int>(png.height), {}};
  image.pixels.resize(static_cast<std::size_t>(png.width) * png.height);
  if (!png_image_finish_read(&png, nullptr, image.pixels.data(), 0, nullptr)) {
    const std::string message = png.message;
    png_image_free(&png);
    throw Error(path, "reading PNG: " + message);
  }
  return image;
}

}  // namespace strata
