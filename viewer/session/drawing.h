#pragma once
#include <memory>
#include <optional>
#include <string>

#include "core/box.h"
#include "core/draw_options.h"
#include "core/image.h"
#include "core/picture.h"
#include "io/store/store.h"
#include "render/create_rasterizer.h"
#include "render/progressive/progressive_rasterizer.h"

namespace strata {

/// "rgb", "intensity", "elevation", "classification", "level", "return", "normal", "precision", "overdraw"; "auto" is
/// nothing. Throws UsageError for another name.
std::optional<ColourMode> parseColour(const std::string& name);
const char* colourName(ColourMode mode);

/// What shows a store best: its colours where it has any, else its intensity where that varies, else the elevation.
ColourMode bestColour(const StoreInfo& info);

/// Colour, intensity from the 1st to the 99th percentile, elevation over `bounds`.
DrawOptions drawOptionsFor(const StoreInfo& info, const Box& bounds, std::optional<ColourMode> colour);

/// The progressive rasterizer where there are options for it, else the one of `backend`; see createRasterizer() for
/// `context` and errors.
std::unique_ptr<Rasterizer> createRasterizerFor(Backend backend, const std::optional<ProgressiveOptions>& progressive,
                                                std::unique_ptr<GlContext> context);

/// The same without a window. `automatic` falls back to the cpu where there is no OpenGL.
std::unique_ptr<Rasterizer> createWindowlessRasterizer(
    Backend backend, const std::optional<ProgressiveOptions>& progressive = std::nullopt);

Image imageOf(const Picture& frame);

/// "1920x1080" as width and height, 1 to 16384 each. Throws UsageError.
struct PictureSize {
  int width = 1920;
  int height = 1080;
};
PictureSize parseSize(const std::string& text);

}  // namespace strata
