#pragma once
#include <cstdint>
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
/// The bytes of the PNG file, for embedding in a report.
std::vector<std::uint8_t> encodePng(const Image& image);
/// Throws Error when the file is missing or is no 8-bit PNG.
Image readPng(const std::string& path);

}  // namespace strata
