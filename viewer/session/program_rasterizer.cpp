#include "viewer/session/program_rasterizer.h"

#include <utility>

#include "core/error.h"
#include "render/gl/gl_context.h"

namespace strata {

std::unique_ptr<Rasterizer> createRasterizerFor(Backend backend, const std::optional<ProgressiveOptions>& progressive,
                                                std::unique_ptr<GlContext> context) {
  if (progressive) return createProgressiveRasterizer(std::move(context), *progressive);
  return createRasterizer(backend, {}, std::move(context));
}

std::unique_ptr<Rasterizer> createWindowlessRasterizer(Backend backend,
                                                       const std::optional<ProgressiveOptions>& progressive) {
  if (!progressive && backend == Backend::cpu) return createRasterizer(backend, {}, nullptr);
  if (progressive || backend != Backend::automatic)
    return createRasterizerFor(backend, progressive, createHeadlessContext());
  std::unique_ptr<GlContext> context;
  try {
    context = createHeadlessContext();
  } catch (const Error&) {
    // No OpenGL at all is no failure here: automatic then means the cpu.
    context = nullptr;
  }
  return createRasterizer(backend, {}, std::move(context));
}

}  // namespace strata
