#pragma once
#include <memory>

#include "render/gl/gl_context.h"
#include "render/rasterizer.h"
#include "render/rasterizer_options.h"

namespace strata {

/// Makes a rasterizer that draws GL_POINTS through the fixed pipeline, as a yardstick for the compute shaders. Any of
/// the points at an equal depth may win a pixel. Images larger than the driver's largest framebuffer stay empty. Throws
/// Error where the context cannot.
std::unique_ptr<Rasterizer> createPointsRasterizer(std::unique_ptr<GlContext> context,
                                                   const RasterizerOptions& options);

}  // namespace strata
