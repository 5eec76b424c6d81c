#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace strata {

/// Text made safe inside HTML elements and quoted attributes.
std::string htmlEscape(std::string_view text);
/// RFC 4648.
std::string base64(std::span<const std::uint8_t> bytes);

}  // namespace strata
