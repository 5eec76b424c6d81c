#include "core/readable.h"

#include <cmath>
#include <cstdio>

namespace strata {
namespace {

/// Three significant digits, or more when that many stand before the point.
std::string threeDigits(double value) {
  const double size = std::abs(value);
  char text[48];
  std::snprintf(text, sizeof text, "%.*f", value == 0.0 || size >= 100.0 ? 0 : size >= 10.0 ? 1 : 2, value);
  return text;
}

std::string scaled(double value, const char* unit) {
  static constexpr const char* kPrefixes[] = {"", "k", "M", "G", "T"};
  int step = 0;
  while (std::abs(value) >= 999.5 && step < 4) {
    value /= 1000.0;
    ++step;
  }
  const bool whole = step == 0 && value == std::floor(value);
  char text[48];
  std::snprintf(text, sizeof text, "%.0f", value);
  const std::string suffix = std::string(kPrefixes[step]) + unit;
  return (whole ? std::string(text) : threeDigits(value)) + (suffix.empty() ? "" : " " + suffix);
}

}  // namespace

std::string readableCount(double value) { return scaled(value, ""); }
std::string readableBytes(double bytes) { return scaled(bytes, "B"); }
std::string readableMs(double ms) {
  return std::abs(ms) >= 1000.0 ? threeDigits(ms / 1000.0) + " s" : threeDigits(ms) + " ms";
}

std::string grouped(std::uint64_t count) {
  std::string digits = std::to_string(count);
  for (std::size_t at = digits.size(); at > 3;) digits.insert(at -= 3, 1, ' ');
  return digits;
}

}  // namespace strata
