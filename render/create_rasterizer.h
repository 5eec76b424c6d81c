#pragma once
#include <cstdint>
#include <memory>
#include <string_view>

#include "render/gl/gl_context.h"
#include "render/rasterizer.h"
#include "render/rasterizer_options.h"

namespace strata {

enum class Backend : std::uint8_t { automatic, cpu, compute32, compute64, computeLock, points };

/// "auto", "cpu", "compute32", "compute64", "compute_lock", "points". Throws UsageError, naming the choices, for
/// anything else.
Backend parseBackend(std::string_view name);

/// Takes over `context`; null will do for cpu, which lets go of one it is given. `automatic` is cpu where there is no
/// context or OpenGL runs on the CPU or lacks what compute32 needs, else compute64, or compute32 where the driver lacks
/// 64-bit atomics. Throws Error where the backend cannot work with the context.
std::unique_ptr<Rasterizer> createRasterizer(Backend backend, const RasterizerOptions& options,
                                             std::unique_ptr<GlContext> context);

}  // namespace strata
