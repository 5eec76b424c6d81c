#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace strata {

/// Colours alone, 8-bit RGBA as R | G<<8 | B<<16 | A<<24, row 0 on top.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint32_t> pixels;
};

/// Writes the image as a PNG file. Throws Error when the file cannot be written whole.
void writePng(const std::string& path, const Image& image);

/// Writes a PNG from the top down, so that a picture of any size takes the memory of a few rows. The file has another
/// name beside the final one until it is whole.
class PngWriter {
 public:
  /// Creates the file. Throws Error when that fails.
  PngWriter(const std::string& path, int width, int height);
  /// Removes the file if it is not finished.
  ~PngWriter();
  PngWriter(const PngWriter&) = delete;
  PngWriter& operator=(const PngWriter&) = delete;

  /// Writes the next `rows` rows of `width` pixels. Throws Error when that fails.
  void add(const std::uint32_t* pixels, int rows);
  /// Call it after the last row: gives the file its name. Throws Error when the file cannot be written whole.
  void finish();

 private:
  struct File;
  std::unique_ptr<File> file_;
};

/// Returns the bytes of the PNG file, for embedding in a report.
std::vector<std::uint8_t> encodePng(const Image& image);
/// Throws Error when the file is missing or is not an 8-bit PNG.
Image readPng(const std::string& path);

}  // namespace strata
