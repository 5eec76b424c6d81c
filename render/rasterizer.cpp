#include "render/rasterizer.h"

#include "core/error.h"
#include "core/log.h"
#include "render/compute32_rasterizer.h"
#include "render/cpu_rasterizer.h"
#include "render/gl_functions.h"
#include "render/points_rasterizer.h"

namespace strata {
namespace {

std::unique_ptr<Rasterizer> createFastest(const RasterizerOptions& options, std::unique_ptr<GlContext> context) {
  if (context == nullptr) return createCpuRasterizer(options);
  try {
    context->makeCurrent();
    if (isSoftwareRenderer(glRenderer(loadGlFunctions(*context)))) return createCpuRasterizer(options);
    return createCompute32Rasterizer(std::move(context), options);
  } catch (const Error& error) {
    logWarning("drawing on the CPU: " + std::string(error.what()));
    return createCpuRasterizer(options);
  }
}

}  // namespace

Backend parseBackend(std::string_view name) {
  if (name == "auto") return Backend::automatic;
  if (name == "cpu") return Backend::cpu;
  if (name == "compute32") return Backend::compute32;
  if (name == "points") return Backend::points;
  throw UsageError("backend: unknown name, found " + std::string(name) + " (expected auto, cpu, compute32 or points)");
}

std::unique_ptr<Rasterizer> createRasterizer(Backend backend, const RasterizerOptions& options,
                                             std::unique_ptr<GlContext> context) {
  switch (backend) {
    case Backend::automatic:
      return createFastest(options, std::move(context));
    case Backend::cpu:
      return createCpuRasterizer(options);
    case Backend::compute32:
      return createCompute32Rasterizer(std::move(context), options);
    case Backend::points:
      return createPointsRasterizer(std::move(context), options);
  }
  throw Error("backend: unknown value");
}

}  // namespace strata
