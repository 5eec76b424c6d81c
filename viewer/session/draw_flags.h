#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/draw_options.h"

namespace CLI {
class App;
}

namespace strata {

/// The options of the command line that say how points are drawn; the same for strata-bench and strata-view.
struct DrawFlags {
  std::string colour = "auto", shading = "plain", classes, background;
  std::string fill;                              ///< empty: 1, or jump-flood for a still
  std::vector<double> range;                     ///< two, or none
  std::vector<std::array<double, 6>> clipBoxes;  ///< x0 y0 z0 x1 y1 z1
  std::vector<std::array<double, 4>> clipPlanes;
};

void addDrawFlags(CLI::App& app, DrawFlags& flags);

/// The colour mode; nothing for "auto". Throws UsageError, which names the option, for an unknown mode.
std::optional<ColourMode> colourOf(const DrawFlags& flags);
/// Applies all flags except the colour mode, which must be set before, as --range depends on it. Throws UsageError,
/// which names the option, for a value that cannot be understood.
void applyDrawFlags(const DrawFlags& flags, DrawOptions& draw);

/// "2,6,9-11" as a set. Throws UsageError.
std::bitset<256> parseClasses(const std::string& text);
/// "1a2b3c" as red, green, blue. Throws UsageError.
glm::u8vec3 parseHexColour(const std::string& text);

}  // namespace strata
