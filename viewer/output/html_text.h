#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace strata {

/// Text made safe inside HTML elements and quoted attributes.
std::string htmlEscape(std::string_view text);
/// `bytes` in base64, as RFC 4648 defines it.
std::string base64(std::span<const std::uint8_t> bytes);

}  // namespace strata
