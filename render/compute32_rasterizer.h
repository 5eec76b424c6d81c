#pragma once
#include <memory>

#include "render/gl_context.h"
#include "render/rasterizer.h"

namespace strata {

/// Draws with compute shaders of plain OpenGL 4.3: a depth pass, then an index pass, each with 32-bit atomic minima
/// (Schütz 2022, 3.2 does both in one with 64 bits). Throws Error where the context cannot.
std::unique_ptr<Rasterizer> createCompute32Rasterizer(std::unique_ptr<GlContext> context,
                                                      const RasterizerOptions& options);

}  // namespace strata
