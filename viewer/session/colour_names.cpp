#include "viewer/session/colour_names.h"

#include <utility>

#include "core/error.h"

namespace strata {
namespace {

constexpr std::pair<const char*, ColourMode> kColours[] = {{"rgb", ColourMode::rgb},
                                                           {"intensity", ColourMode::intensity},
                                                           {"elevation", ColourMode::elevation},
                                                           {"classification", ColourMode::classification},
                                                           {"level", ColourMode::level},
                                                           {"return", ColourMode::returnNumber},
                                                           {"normal", ColourMode::normal},
                                                           {"precision", ColourMode::precision},
                                                           {"overdraw", ColourMode::overdraw}};

}  // namespace

std::optional<ColourMode> parseColour(const std::string& name) {
  if (name == "auto") return std::nullopt;
  for (const auto& [known, mode] : kColours)
    if (name == known) return mode;
  throw UsageError("--colour", "unknown name, found " + name +
                                   " (expected auto, rgb, intensity, elevation, classification, level, return, normal, "
                                   "precision or overdraw)");
}

const char* colourName(ColourMode mode) {
  for (const auto& [name, known] : kColours)
    if (mode == known) return name;
  return "unknown";
}

}  // namespace strata
