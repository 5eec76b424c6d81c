#pragma once
#include <optional>
#include <string>

#include "core/draw_options.h"

namespace strata {

/// Reads "rgb", "intensity", "elevation", "classification", "level", "return", "normal", "precision" or "overdraw";
/// "auto" gives nothing. Throws UsageError for another name.
std::optional<ColourMode> parseColour(const std::string& name);
/// The name that parseColour() reads as `mode`.
const char* colourName(ColourMode mode);

}  // namespace strata
