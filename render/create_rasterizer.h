#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "render/gl/gl_context.h"
#include "render/rasterizer.h"
#include "render/rasterizer_options.h"

namespace strata {

/// The rasterizers that a user may choose from. Progressive drawing is none of them: it has options of its own.
enum class Backend : std::uint8_t { automatic, cpu, compute32, compute64, computeLock, points };

/// The names of all backends in the order of the enumeration: "auto", "cpu", "compute32", ...
std::span<const char* const> backendNames();
/// All names as one phrase: "auto, cpu, compute32, compute64, compute_lock or points".
std::string backendChoices();
/// The backend of this name. Throws UsageError, which lists the choices, for any other name.
Backend parseBackend(std::string_view name);

/// Takes over `context`, which may be null for cpu. `automatic` means cpu where there is no context, where OpenGL runs
/// on the CPU, and where it lacks what compute32 needs; otherwise it means compute64, or compute32 where the driver
/// lacks 64-bit atomics. Throws Error where the backend cannot work with the context.
std::unique_ptr<Rasterizer> createRasterizer(Backend backend, const RasterizerOptions& options,
                                             std::unique_ptr<GlContext> context);

}  // namespace strata
