#include "render/create_rasterizer.h"

#include <iterator>

#include "core/error.h"
#include "core/log.h"
#include "render/cpu/cpu_rasterizer.h"
#include "render/gl/gl_functions.h"
#include "render/gpu/compute_rasterizer.h"
#include "render/gpu/points_rasterizer.h"

namespace strata {
namespace {

constexpr const char* kBackendNames[] = {"auto", "cpu", "compute32", "compute64", "compute_lock", "points"};

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

std::span<const char* const> backendNames() { return kBackendNames; }

std::string backendChoices() {
  const std::span<const char* const> names = backendNames();
  std::string text = names.front();
  for (const char* name : names.subspan(1, names.size() - 2)) text += std::string(", ") + name;
  return text + " or " + names.back();
}

Backend parseBackend(std::string_view name) {
  for (std::size_t i = 0; i < std::size(kBackendNames); ++i)
    if (name == kBackendNames[i]) return static_cast<Backend>(i);
  throw UsageError("backend: unknown name, found " + std::string(name) + " (expected " + backendChoices() + ")");
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
