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

constexpr int kQuickCompression = 3;  // zlib's level; large pictures take long enough to draw

}  // namespace

/// Keeps libpng's jumps and our exceptions apart: no object with a destructor is made in a function that sets
/// a jump's target.
struct PngWriter::File {
  std::string path, building, message;
  int width = 0;
  std::FILE* stream = nullptr;
  png_structp png = nullptr;
  png_infop info = nullptr;

  ~File() {
    png_destroy_write_struct(&png, &info);
    if (stream == nullptr) return;
    std::fclose(stream);
    std::remove(building.c_str());
  }

  static void failed(png_structp png, png_const_charp message) {
    static_cast<File*>(png_get_error_ptr(png))->message = message;
    png_longjmp(png, 1);
  }
  static void warned(png_structp, png_const_charp) {}

  bool begin(int height) {
    if (setjmp(png_jmpbuf(png)) != 0) return false;
    png_init_io(png, stream);
    png_set_compression_level(png, kQuickCompression);
    png_set_IHDR(png, info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), 8, PNG_COLOR_TYPE_RGBA,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_write_info(png, info);
    return true;
  }
  bool add(const std::uint32_t* pixels, int rows) {
    if (setjmp(png_jmpbuf(png)) != 0) return false;
    for (int y = 0; y < rows; ++y)
      png_write_row(png, reinterpret_cast<png_const_bytep>(pixels + static_cast<std::size_t>(y) *
                                                                        static_cast<std::size_t>(width)));
    return true;
  }
  bool end() {
    if (setjmp(png_jmpbuf(png)) != 0) return false;
    png_write_end(png, nullptr);
    return true;
  }
};

PngWriter::PngWriter(const std::string& path, int width, int height) : file_(std::make_unique<File>()) {
  file_->path = path;
  file_->building = path + ".building";
  file_->width = width;
  file_->stream = std::fopen(file_->building.c_str(), "wb");
  if (file_->stream == nullptr) throw posixError(path, "creating", errno);
  file_->png = png_create_write_struct(PNG_LIBPNG_VER_STRING, file_.get(), File::failed, File::warned);
  if (file_->png != nullptr) file_->info = png_create_info_struct(file_->png);
  if (file_->info == nullptr) throw Error(path, "writing PNG: out of memory");
  if (!file_->begin(height)) throw Error(path, "writing PNG: " + file_->message);
}

PngWriter::~PngWriter() = default;

void PngWriter::add(const std::uint32_t* pixels, int rows) {
  if (!file_->add(pixels, rows)) throw Error(file_->path, "writing PNG: " + file_->message);
}

void PngWriter::finish() {
  if (!file_->end()) throw Error(file_->path, "writing PNG: " + file_->message);
  const bool closed = std::fclose(file_->stream) == 0;
  const int closeError = errno;
  file_->stream = nullptr;
  if (closed && std::rename(file_->building.c_str(), file_->path.c_str()) == 0) return;
  const int failure = closed ? errno : closeError;
  std::remove(file_->building.c_str());
  throw posixError(file_->path, "writing", failure);
}

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
