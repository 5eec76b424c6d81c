#pragma once
#include <memory>

#include "render/gl/gl_context.h"
#include "render/gpu/compute_way.h"
#include "render/rasterizer.h"
#include "render/rasterizer_options.h"

namespace strata {

/// For measurements (tests/bench); the defaults are what everybody draws with.
struct ComputeExperiment {
  bool prefetch = true;           ///< four points with one load (Schütz 2022, 3.4); without it compute64 and lock only
  int forcedPlanes = 0;           ///< 1 to 3: read so many, and cull nothing (Schütz 2022, 4.4.2); 0: neither
  std::uint32_t lockTurns = 256;  ///< after which compute_lock gives a point up
};

/// Whether the current context has what compute64 needs.
bool hasWideAtomics(GlContext& context);

/// Draws with compute shaders of OpenGL 4.3; compute64 also needs 64-bit integers and their atomics, by the names
/// GL_ARB_gpu_shader_int64 and GL_NV_shader_atomic_int64 (or EXT). Throws Error, naming what is missing, where the
/// context cannot.
std::unique_ptr<Rasterizer> createComputeRasterizer(ComputeWay way, std::unique_ptr<GlContext> context,
                                                    const RasterizerOptions& options,
                                                    const ComputeExperiment& experiment = {});

}  // namespace strata
