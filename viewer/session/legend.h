#pragma once
#include <bitset>
#include <cstdint>
#include <string>
#include <vector>

#include "core/draw_options.h"

namespace strata {

/// Explains the colours of a picture.
struct Legend {
  struct Entry {
    std::uint32_t colour = 0;  ///< R | G<<8 | B<<16 | 255<<24
    std::string label;
  };
  std::vector<Entry> entries;          ///< the meaning of single colours
  std::vector<std::uint32_t> colours;  ///< evenly spaced colours of a scale from `low` to `high`; empty = no scale
  std::string low, high;
};

/// The legend is empty for the points' own colours. `classes` are the classes to name, and `levels` is the number of
/// levels of the deepest store.
Legend legendOf(const DrawOptions& options, const std::bitset<256>& classes, int levels);

}  // namespace strata
