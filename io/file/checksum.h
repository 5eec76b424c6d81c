#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

namespace strata {

/// XXH3-64, which is the checksum of everything in a store.
std::uint64_t checksum(std::span<const std::byte> bytes, std::uint64_t seed = 0);

}  // namespace strata
