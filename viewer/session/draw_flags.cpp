#include "viewer/session/draw_flags.h"

#include <CLI/CLI.hpp>
#include <charconv>
#include <sstream>

#include "core/error.h"
#include "viewer/session/colour_names.h"

namespace strata {
namespace {

constexpr const char* kJumpFlood = "jump-flood";

/// The whole of `text` as a number of this base and at most `most`, or nothing.
std::optional<unsigned> parseNumber(std::string_view text, int base, unsigned most) {
  unsigned value = 0;
  const auto [rest, failure] = std::from_chars(text.data(), text.data() + text.size(), value, base);
  if (failure != std::errc() || rest != text.data() + text.size() || value > most) return std::nullopt;
  return value;
}

template <std::size_t kCount>
void addRepeated(CLI::App& app, const std::string& name, std::vector<std::array<double, kCount>>& into,
                 const std::string& help) {
  app.add_option_function<std::vector<double>>(
         name,
         [&into, name](const std::vector<double>& values) {
           if (values.size() % kCount != 0 || values.size() / kCount > Clip::kMost)
             throw CLI::ValidationError(name, "expected " + std::to_string(kCount) + " numbers, at most " +
                                                  std::to_string(Clip::kMost) + " times");
           for (std::size_t i = 0; i < values.size(); i += kCount) {
             std::array<double, kCount> one;
             std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(i), kCount, one.begin());
             into.push_back(one);
           }
         },
         help)
      ->expected(static_cast<int>(kCount), static_cast<int>(kCount * Clip::kMost));
}

}  // namespace

void addDrawFlags(CLI::App& app, DrawFlags& flags) {
  app.add_option("--colour", flags.colour,
                 "auto, rgb, intensity, elevation, classification, level, return, normal, precision or overdraw")
      ->capture_default_str();
  app.add_option("--shading", flags.shading, "plain, or hq: the mean of what lies within 1 % of the front")
      ->check(CLI::IsMember({"plain", "hq"}))
      ->capture_default_str();
  app.add_option("--range", flags.range, "LOW HIGH: ends of the colour map, for intensity or elevation in metres")
      ->expected(2);
  app.add_option("--classes", flags.classes, "draw these classes alone, such as 2,6,9-11");
  app.add_option("--background", flags.background, "RRGGBB, or TOP,BELOW for a gradient");
  app.add_option("--fill", flags.fill,
                 "holes are filled out of a window of 3, 5 or 7 pixels, by depth, or by jump-flood, "
                 "with splats as large as the points lie apart (default: 1; for stills in colour jump-flood)")
      ->check(CLI::IsMember({"1", "3", "5", "7", kJumpFlood}));
  addRepeated(app, "--clip-box", flags.clipBoxes, "X0 Y0 Z0 X1 Y1 Z1: draw only what is in one of these boxes");
  addRepeated(app, "--clip-plane", flags.clipPlanes, "A B C D: draw only where Ax + By + Cz + D >= 0");
}

std::optional<ColourMode> colourOf(const DrawFlags& flags) { return parseColour(flags.colour); }

std::bitset<256> parseClasses(const std::string& text) {
  std::bitset<256> classes;
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');) {
    const std::size_t dash = part.find('-');
    const auto first = parseNumber(std::string_view(part).substr(0, dash), 10, 255);
    const auto last = dash == std::string::npos ? first : parseNumber(std::string_view(part).substr(dash + 1), 10, 255);
    if (!first || !last || *last < *first)
      throw UsageError("--classes", "found " + part + " (expected classes from 0 to 255, such as 2,6,9-11)");
    for (unsigned c = *first; c <= *last; ++c) classes.set(c);
  }
  return classes;
}

glm::u8vec3 parseHexColour(const std::string& text) {
  const auto value = text.size() == 6 ? parseNumber(text, 16, 0xffffffu) : std::nullopt;
  if (!value) throw UsageError("--background", "found " + text + " (expected RRGGBB, such as 181a1e)");
  return {*value >> 16 & 255u, *value >> 8 & 255u, *value & 255u};
}

void applyDrawFlags(const DrawFlags& flags, DrawOptions& draw) {
  draw.shading = flags.shading == "hq" ? Shading::highQuality : Shading::plain;
  draw.jumpFlood = flags.fill == kJumpFlood;
  draw.fill = draw.jumpFlood || flags.fill.empty() ? 1 : std::stoi(flags.fill);
  if (flags.range.size() == 2) {
    draw.elevationRange = {flags.range[0], flags.range[1]};
    draw.intensityRange = glm::vec2(draw.elevationRange);
  }
  if (!flags.classes.empty()) draw.classes = parseClasses(flags.classes);
  if (!flags.background.empty()) {
    const std::size_t comma = flags.background.find(',');
    draw.background = parseHexColour(flags.background.substr(0, comma));
    if (comma != std::string::npos) draw.backgroundBelow = parseHexColour(flags.background.substr(comma + 1));
  }
  for (const auto& box : flags.clipBoxes) {
    Box clip;
    clip.add({box[0], box[1], box[2]});
    clip.add({box[3], box[4], box[5]});
    draw.clip.boxes.push_back(clip);
  }
  for (const auto& plane : flags.clipPlanes) draw.clip.planes.emplace_back(plane[0], plane[1], plane[2], plane[3]);
}

}  // namespace strata
