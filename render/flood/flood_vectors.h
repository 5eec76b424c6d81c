#pragma once

namespace strata {

inline constexpr int kFloodTile = 16;  ///< pixels of a row that are searched at once, a multiple of every vector length

}  // namespace strata
