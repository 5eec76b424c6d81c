#pragma once
#include <charconv>
#include <string>
#include <string_view>
#include <system_error>

namespace strata {

/// `text` with A to Z as a to z.
inline std::string lowerCase(std::string_view text) {
  std::string lower(text);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return lower;
}

/// Reads the whole of `text`, which has no blanks and no leading +, as a number. False when it is none or does not fit.
template <typename T>
bool parseWhole(std::string_view text, T& value) {
  const char* const textEnd = text.data() + text.size();
  const auto [end, failure] = std::from_chars(text.data(), textEnd, value);
  return failure == std::errc() && end == textEnd;
}

}  // namespace strata
