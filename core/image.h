#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace strata {

/// 8-bit RGBA, row 0 on top, R | G<<8 | B<<16 | A<<24.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint32_t> pixels;
};

/// Throws Error when the file cannot be written whole.
void writePng(const std::string& path, const Image& image);

/// A PNG written from the top down, so that a picture of any size takes the memory of a few rows. The file stands
/// beside its final name until it is whole.
class PngWriter {
 public:
  /// Throws Error when the file cannot be made.
  PngWriter(const std::string& path, int width, int height);
  /// Removes a file that is not finished.
  ~PngWriter();
  PngWriter(const PngWriter&) = delete;
  PngWriter& operator=(const PngWriter&) = delete;

  /// `rows` rows of `width` pixels. Throws Error when they cannot be written.
  void add(const std::uint32_t* pixels, int rows);
  /// After the last row. Throws Error when the file cannot be written whole.
  void finish();

 private:
  struct File;
  std::unique_ptr<File> file_;
};

/// The bytes of the PNG file, for embedding in a report.
std::vector<std::uint8_t> encodePng(const Image& image);
/// Throws Error when the file is missing or is no 8-bit PNG.
Image readPng(const std::string& path);

}  // namespace strata
