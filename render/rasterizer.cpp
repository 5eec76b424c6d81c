#include "render/rasterizer.h"

#include <algorithm>

#include "core/error.h"
#include "core/log.h"
#include "render/compute_rasterizer.h"
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
    const ComputeWay way = hasWideAtomics(*context) ? ComputeWay::compute64 : ComputeWay::compute32;
    return createComputeRasterizer(way, std::move(context), options);
  } catch (const Error& error) {
    logWarning("drawing on the CPU: " + std::string(error.what()));
    return createCpuRasterizer(options);
  }
}

}  // namespace

void addStats(const DrawStats& one, DrawStats& sum) {
  sum.pointsDrawn += one.pointsDrawn;
  sum.batchesDrawn += one.batchesDrawn;
  sum.batchesCulled += one.batchesCulled;
  for (int p = 0; p < 3; ++p) sum.batchesAt[p] += one.batchesAt[p];
  sum.nodesNotUploaded = std::max(sum.nodesNotUploaded, one.nodesNotUploaded);
  sum.bytesUploaded += one.bytesUploaded;
  sum.gpuBytes = std::max(sum.gpuBytes, one.gpuBytes);
  sum.pointsPending = std::max(sum.pointsPending, one.pointsPending);
  sum.lockRetries += one.lockRetries;
  sum.lockRepairs += one.lockRepairs;
  sum.uploadMs += one.uploadMs;
  sum.drawMs += one.drawMs;
  sum.resolveMs += one.resolveMs;
  sum.gpuMs += one.gpuMs;
}

DrawStats Rasterizer::drawViews(const RenderList& list, std::span<const View> views, const DrawOptions& options,
                                std::span<Frame> frames) {
  DrawStats sum;
  for (std::size_t i = 0; i < std::min(views.size(), frames.size()); ++i)
    addStats(draw(list, views[i], options, frames[i]), sum);
  return sum;
}

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
