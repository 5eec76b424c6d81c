#pragma once
#include <memory>

#include "render/gl/gl_context.h"
#include "render/gpu/compute_way.h"
#include "render/rasterizer.h"
#include "render/rasterizer_options.h"

namespace strata {

/// What the measurements of the papers' tables change about the shaders; everybody else draws with the defaults. It
/// stays here because the tables measure these shaders, and a copy of them would measure something else.
struct ComputeExperiment {
  bool prefetch = true;           ///< load four points at once (Schütz 2022, 3.4); compute32 always does
  int forcedPlanes = 0;           ///< 1 to 3: read so many planes and cull nothing (Schütz 2022, 4.4.2); 0: neither
  std::uint32_t lockTurns = 256;  ///< attempts after which compute_lock gives a point up
};

/// True when `context`, which is current, has what compute64 needs.
bool hasWideAtomics(GlContext& context);

/// Makes a rasterizer that draws with compute shaders of OpenGL 4.3. compute64 also needs 64-bit integers in shaders
/// and their atomics (GL_ARB_gpu_shader_int64, and GL_NV_shader_atomic_int64 or its EXT twin). Throws Error naming the
/// missing feature when the context lacks one.
std::unique_ptr<Rasterizer> createComputeRasterizer(ComputeWay way, std::unique_ptr<GlContext> context,
                                                    const RasterizerOptions& options,
                                                    const ComputeExperiment& experiment = {});

}  // namespace strata
