#include "viewer/session/drawing.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "core/error.h"
#include "render/create_rasterizer.h"
#include "render/gl/gl_context.h"

namespace strata {
namespace {

constexpr int kLargestSide = 16384;

constexpr std::pair<const char*, ColourMode> kColours[] = {{"rgb", ColourMode::rgb},
                                                           {"intensity", ColourMode::intensity},
                                                           {"elevation", ColourMode::elevation},
                                                           {"classification", ColourMode::classification},
                                                           {"level", ColourMode::level},
                                                           {"return", ColourMode::returnNumber},
                                                           {"normal", ColourMode::normal},
                                                           {"precision", ColourMode::precision},
                                                           {"overdraw", ColourMode::overdraw}};

std::optional<AttributeRange> rangeOf(const StoreInfo& info, std::string_view name) {
  const int index = info.layout.find(name);
  if (index < 0 || static_cast<std::size_t>(index) >= info.ranges.size()) return std::nullopt;
  return info.ranges[static_cast<std::size_t>(index)];
}

bool varies(const std::optional<AttributeRange>& range) { return range && range->max > range->min; }

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

ColourMode bestColour(const StoreInfo& info) {
  if (varies(rangeOf(info, attribute::kRgb))) return ColourMode::rgb;
  if (varies(rangeOf(info, attribute::kIntensity))) return ColourMode::intensity;
  return ColourMode::elevation;
}

DrawOptions drawOptionsFor(const StoreInfo& info, const Box& bounds, std::optional<ColourMode> colour) {
  DrawOptions draw;
  draw.colour = colour.value_or(bestColour(info));
  if (const auto range = rangeOf(info, attribute::kIntensity)) {
    const bool gathered = range->high > range->low;
    draw.intensityRange = {static_cast<float>(gathered ? range->low : range->min),
                           static_cast<float>(gathered ? range->high : std::max(range->max, range->min + 1.0))};
  }
  if (!bounds.empty()) draw.elevationRange = {bounds.min.z, std::max(bounds.max.z, bounds.min.z + 1e-6)};
  return draw;
}

std::unique_ptr<Rasterizer> createRasterizerFor(Backend backend, const std::optional<ProgressiveOptions>& progressive,
                                                std::unique_ptr<GlContext> context) {
  if (progressive) return createProgressiveRasterizer(std::move(context), *progressive);
  return createRasterizer(backend, {}, std::move(context));
}

std::unique_ptr<Rasterizer> createWindowlessRasterizer(Backend backend,
                                                       const std::optional<ProgressiveOptions>& progressive) {
  if (!progressive && backend == Backend::cpu) return createRasterizer(backend, {}, nullptr);
  if (progressive || backend != Backend::automatic)
    return createRasterizerFor(backend, progressive, createHeadlessContext());
  std::unique_ptr<GlContext> context;
  try {
    context = createHeadlessContext();
  } catch (const Error&) {
    // No OpenGL at all is no failure here: automatic then means the cpu.
    context = nullptr;
  }
  return createRasterizer(backend, {}, std::move(context));
}

Image imageOf(const Picture& frame) { return {frame.width, frame.height, frame.colour}; }

PictureSize parseSize(const std::string& text) {
  PictureSize size;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%dx%d%c", &size.width, &size.height, &rest) != 2 || size.width < 1 ||
      size.height < 1 || size.width > kLargestSide || size.height > kLargestSide)
    throw UsageError("--size", "found " + text + " (expected WIDTHxHEIGHT, 1 to 16384 each)");
  return size;
}

}  // namespace strata
