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

/// The colour mode that shows a store best: its colours if they vary, else its intensity if that varies, else the
/// elevation.
ColourMode bestColour(const StoreInfo& info);

/// The options for drawing a store: the colour mode, an intensity range from the 1st to the 99th percentile, and the
/// elevation range of `bounds`.
DrawOptions drawOptionsFor(const StoreInfo& info, const Box& bounds, std::optional<ColourMode> colour);

/// The progressive rasterizer when there are options for it, else the one of `backend`; see createRasterizer() for
/// `context` and errors.
std::unique_ptr<Rasterizer> createRasterizerFor(Backend backend, const std::optional<ProgressiveOptions>& progressive,
                                                std::unique_ptr<GlContext> context);

/// The same without a window. `automatic` falls back to the cpu when there is no OpenGL.
std::unique_ptr<Rasterizer> createWindowlessRasterizer(
    Backend backend, const std::optional<ProgressiveOptions>& progressive = std::nullopt);

Image imageOf(const Picture& frame);

/// The size of a picture in pixels.
struct PictureSize {
  int width = 1920;
  int height = 1080;
};
/// Reads "1920x1080"; width and height are 1 to 16384 each. Throws UsageError.
PictureSize parseSize(const std::string& text);

}  // namespace strata
