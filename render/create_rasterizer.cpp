#include "render/create_rasterizer.h"

#include "core/error.h"
#include "core/log.h"
#include "render/cpu/cpu_rasterizer.h"
#include "render/gl/gl_functions.h"
#include "render/gpu/compute_rasterizer.h"
#include "render/gpu/points_rasterizer.h"

namespace strata {
namespace {

std::unique_ptr<Rasterizer> createFastest(const RasterizerOptions& options, std::unique_ptr<GlContext> context) {
  if (context == nullptr) return createCpuRasterizer(options);
  try {
    context->makeCurrent();
    if (isSoftwareRenderer(glRenderer(loadGlFunctions(*context)))) return createCpuRasterizer(options);
    const ComputeWay way = hasWideAtomics(*context) ? ComputeWay::compute64 : ComputeWay::compute32;
    return createComputeRasterizer(way, std::move(context), options);
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
  if (name == "compute64") return Backend::compute64;
  if (name == "compute_lock") return Backend::computeLock;
  if (name == "points") return Backend::points;
  throw UsageError("backend: unknown name, found " + std::string(name) +
                   " (expected auto, cpu, compute32, compute64, compute_lock or points)");
}

std::unique_ptr<Rasterizer> createRasterizer(Backend backend, const RasterizerOptions& options,
                                             std::unique_ptr<GlContext> context) {
  switch (backend) {
    case Backend::automatic:
      return createFastest(options, std::move(context));
    case Backend::cpu:
      return createCpuRasterizer(options);
    case Backend::compute32:
      return createComputeRasterizer(ComputeWay::compute32, std::move(context), options);
    case Backend::compute64:
      return createComputeRasterizer(ComputeWay::compute64, std::move(context), options);
    case Backend::computeLock:
      return createComputeRasterizer(ComputeWay::computeLock, std::move(context), options);
    case Backend::points:
      return createPointsRasterizer(std::move(context), options);
  }
  throw Error("backend: unknown value");
}

}  // namespace strata
