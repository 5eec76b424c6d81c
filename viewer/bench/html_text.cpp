#include "viewer/bench/html_text.h"

#include <cmath>
#include <cstdio>

namespace strata {
namespace {

/// Three significant digits, or all of those before the point.
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

std::string htmlEscape(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string base64(std::span<const std::uint8_t> bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t left = bytes.size() - i;
    const std::uint32_t group = static_cast<std::uint32_t>(bytes[i]) << 16 |
                                (left > 1 ? static_cast<std::uint32_t>(bytes[i + 1]) << 8 : 0u) |
                                (left > 2 ? static_cast<std::uint32_t>(bytes[i + 2]) : 0u);
    out += kDigits[group >> 18];
    out += kDigits[group >> 12 & 63];
    out += left > 1 ? kDigits[group >> 6 & 63] : '=';
    out += left > 2 ? kDigits[group & 63] : '=';
  }
  return out;
}

std::string readableCount(double value) { return scaled(value, ""); }
std::string readableBytes(double bytes) { return scaled(bytes, "B"); }
std::string readableMs(double ms) {
  return std::abs(ms) >= 1000.0 ? threeDigits(ms / 1000.0) + " s" : threeDigits(ms) + " ms";
}

}  // namespace strata
