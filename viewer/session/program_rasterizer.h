#pragma once
#include <memory>
#include <optional>

#include "render/create_rasterizer.h"
#include "render/progressive/progressive_rasterizer.h"

namespace strata {

/// The progressive rasterizer when there are options for it, else the one of `backend`; see createRasterizer() for
/// `context` and errors.
std::unique_ptr<Rasterizer> createRasterizerFor(Backend backend, const std::optional<ProgressiveOptions>& progressive,
                                                std::unique_ptr<GlContext> context);

/// The same without a window. `automatic` falls back to the cpu when there is no OpenGL.
std::unique_ptr<Rasterizer> createWindowlessRasterizer(
    Backend backend, const std::optional<ProgressiveOptions>& progressive = std::nullopt);

}  // namespace strata
