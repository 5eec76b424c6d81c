#pragma once
#include <memory>

#include "render/gl/gl_context.h"
#include "render/rasterizer.h"
#include "render/rasterizer_options.h"

namespace strata {

/// Draws GL_POINTS through the fixed pipeline: the yardstick for the compute shaders. Depth ties go to any point.
/// Throws Error where the context cannot. Images larger than the driver's largest framebuffer stay empty.
std::unique_ptr<Rasterizer> createPointsRasterizer(std::unique_ptr<GlContext> context,
                                                   const RasterizerOptions& options);

}  // namespace strata
