#pragma once
#include <cstddef>

namespace strata {

/// Asks the system to back the whole 2 MiB blocks of [begin, begin + bytes) with large pages, which must not have been
/// written yet. Nothing happens where the system has none.
void adviseLargePages(void* begin, std::size_t bytes);

}  // namespace strata
