#pragma once

namespace strata {

inline constexpr int kFloodTile = 16;  ///< pixels of a row that are searched at once: a multiple of any vector's

}  // namespace strata
