#pragma once
#include <cstddef>

namespace strata {

/// Asks the system for large pages for the whole 2 MiB blocks in [begin, begin + bytes). The memory should not have
/// been written yet. Nothing happens where the system has no large pages.
void adviseLargePages(void* begin, std::size_t bytes);

}  // namespace strata
