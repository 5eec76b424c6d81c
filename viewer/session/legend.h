#pragma once
#include <bitset>
#include <cstdint>
#include <string>
#include <vector>

#include "core/draw_options.h"

namespace strata {

/// What the colours of a picture mean.
struct Legend {
  struct Entry {
    std::uint32_t colour = 0;  ///< R | G<<8 | B<<16 | 255<<24
    std::string label;
  };
  std::vector<Entry> entries;          ///< of separate colours
  std::vector<std::uint32_t> colours;  ///< of a scale, evenly spaced, from `low` to `high`; empty = none
  std::string low, high;
};

/// Empty for the points' own colours. `classes` are those to name; `levels` those of the deepest store.
Legend legendOf(const DrawOptions& options, const std::bitset<256>& classes, int levels);

}  // namespace strata
