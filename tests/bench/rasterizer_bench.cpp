// Measures points per second of each rasterizer at 1920 x 1080. ctest does not run it: rasterizer_bench
// --benchmark_filter=...
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/error.h"
#include "render/cpu/cpu_kernel.h"
#include "render/create_rasterizer.h"
#include "render/plan/batch_plan.h"
#include "tests/support/gl_contexts.h"
#include "tests/support/synthetic_nodes.h"

namespace strata {
namespace {

constexpr double kPointsANode = 40000.0;

/// How many millions of points are drawn: STRATA_BENCH_POINTS, or else 10.
double millions() {
  const char* text = std::getenv("STRATA_BENCH_POINTS");
  return text == nullptr ? 10.0 : std::max(std::atof(text), 0.001);
}

const RenderList& town() {
  // A fifth of the points lies above the ground. A tile has two nodes, of which the upper one is small.
  static const RenderList list =
      test::makeTown(glm::dvec3(456789.0, 5412345.0, 300.0), 500.0, static_cast<std::uint32_t>(0.8e6 * millions()), 1,
                     std::max(1, static_cast<int>(std::sqrt(0.8e6 * millions() / kPointsANode))));
  return list;
}

/// A view that shows the whole town as large as possible.
View farView() {
  View view = viewOfBox(test::boundsOf(town()), {1.0, 0.83, -0.71}, 1920, 1080, 1.0);
  view.eye += (view.target - view.eye) * 0.35;
  return view;
}

View closeView() {
  View view = farView();
  view.eye = view.target + (view.eye - view.target) * 0.15;
  return view;
}

View otherEye(View view) {
  const glm::dvec3 apart = 0.065 * viewBasis(view).right;
  view.eye += apart;
  view.target += apart;
  return view;
}

/// Measures step(), which draws one frame and returns its stats.
template <typename Step>
void measure(benchmark::State& state, const Step& step) {
  DrawStats total;
  for (int warm = 0; warm < 2; ++warm) step();
  for (auto _ : state) addStats(step(), total);
  const auto frames = static_cast<double>(state.iterations());
  const auto points = static_cast<double>(total.pointsDrawn);
  state.counters["points"] = points / frames;
  state.counters["Mpoints/s"] = points / (1000.0 * (total.uploadMs + total.drawMs));
  state.counters["with_resolve"] = points / (1000.0 * (total.uploadMs + total.drawMs + total.resolveMs));
  state.counters["draw_ms"] = total.drawMs / frames;
  state.counters["resolve_ms"] = total.resolveMs / frames;
}

void draw(benchmark::State& state, Rasterizer& rasterizer, const View& view, const DrawOptions& options = {}) {
  Picture picture;
  measure(state, [&] { return rasterizer.draw(town(), view, options, picture); });
}

std::unique_ptr<Rasterizer> cpuRasterizer(const benchmark::State& state) {
  RasterizerOptions options;
  options.threads = static_cast<int>(state.range(0));
  return createRasterizer(Backend::cpu, options, nullptr);
}

void cpu(benchmark::State& state, const View& view) { draw(state, *cpuRasterizer(state), view); }

void cpuWith(benchmark::State& state, int pointSize, int fill, bool edl, Shading shading) {
  DrawOptions options;
  options.pointSize = pointSize;
  options.fill = fill;
  options.edl = edl;
  options.shading = shading;
  draw(state, *cpuRasterizer(state), farView(), options);
}

/// Draws two eyes in one pass over the points, or one after the other.
void eyes(benchmark::State& state, Rasterizer& rasterizer, bool together) {
  const View views[] = {farView(), otherEye(farView())};
  Picture pictures[2];
  measure(state, [&] {
    if (together) return rasterizer.drawViews(town(), views, {}, pictures);
    DrawStats sum = rasterizer.draw(town(), views[0], {}, pictures[0]);
    addStats(rasterizer.draw(town(), views[1], {}, pictures[1]), sum);
    return sum;
  });
}

void cpuEyes(benchmark::State& state, bool together) { eyes(state, *cpuRasterizer(state), together); }

/// Projects one block of points again and again, so that only the kernel is measured, with everything in the
/// first-level cache. Arguments: the number of planes; 1 if the pixels are already nearer than all points; 1 if the
/// batch lies wholly in the image.
void kernel(benchmark::State& state) {
  const auto precision = static_cast<Precision>(state.range(0));
  KernelView view;
  const View far = farView();
  DrawPlan plan;
  planBatches(town(), far, {}, plan);
  const auto whole = std::find_if(plan.batches.begin(), plan.batches.end(), [](const PlannedBatch& batch) {
    return batch.inside && batch.pointCount >= ProjectedBlock::kPoints;
  });
  if (whole == plan.batches.end()) return state.SkipWithError("no batch is wholly in the picture");
  const PlannedBatch& batch = *whole;
  const NodeData& node = *batch.node;
  const GridTransform& grid = plan.grids[batch.mapping.grid];
  view.x = grid.x;
  view.y = grid.y;
  view.depth = grid.depth;
  view.offset = batch.mapping.offset;
  view.shift = batch.mapping.shift;
  for (int axis = 0; axis < 3; ++axis) view.shift[axis] -= 10 * (static_cast<int>(precision) - 1);
  view.port = viewport(plan.constants);
  view.inside = state.range(2) != 0;
  const std::vector<PackedPixel> pixels(1920 * 1080, state.range(1) != 0 ? packPixel(0, 0) : kEmptyPixel);
  view.pixels = pixels.data();
  KernelPoints points;
  for (auto& plane : points.planes) plane = node.position[0].data() + batch.firstPoint;
  points.precision = precision;
  points.count = ProjectedBlock::kPoints;
  ProjectedBlock block;
  for (auto _ : state) {
    projectPoints(points, &view, 1, Wanted::front, &block);
    benchmark::DoNotOptimize(block);
  }
  state.counters["Mpoints/s"] =
      benchmark::Counter(static_cast<double>(points.count) * 1e-6, benchmark::Counter::kIsIterationInvariantRate);
}

std::unique_ptr<Rasterizer> glRasterizer(Backend backend) {
  static const bool kOffered = (test::offerWideAtomicsInSoftware(), true);
  (void)kOffered;
  RasterizerOptions options;
  options.uploadBytesPerFrame = options.gpuBytes;
  return createRasterizer(backend, options, createHeadlessContext());
}

void onGl(benchmark::State& state, Backend backend) {
  try {
    draw(state, *glRasterizer(backend), farView());
  } catch (const Error& error) {
    state.SkipWithError(error.what());
  }
}

void glEyes(benchmark::State& state, Backend backend, bool together) {
  try {
    eyes(state, *glRasterizer(backend), together);
  } catch (const Error& error) {
    state.SkipWithError(error.what());
  }
}

#define STRATA_ON_ONE_AND_TWO(name, ...) \
  BENCHMARK_CAPTURE(name, __VA_ARGS__)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime()
STRATA_ON_ONE_AND_TWO(cpu, far, farView());
STRATA_ON_ONE_AND_TWO(cpu, close, closeView());
STRATA_ON_ONE_AND_TWO(cpuWith, size2_edl, 2, 1, true, Shading::plain);
STRATA_ON_ONE_AND_TWO(cpuWith, fill7, 1, 7, false, Shading::plain);
STRATA_ON_ONE_AND_TWO(cpuWith, high_quality, 1, 1, false, Shading::highQuality);
STRATA_ON_ONE_AND_TWO(cpuEyes, one_after_the_other, false);
STRATA_ON_ONE_AND_TWO(cpuEyes, together, true);
BENCHMARK(kernel)->ArgNames({"planes", "hidden", "inside"})->ArgsProduct({{1, 2, 3}, {0, 1}, {0, 1}});
BENCHMARK_CAPTURE(onGl, compute32, Backend::compute32)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(onGl, compute64, Backend::compute64)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(onGl, compute_lock, Backend::computeLock)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(glEyes, compute32_together, Backend::compute32, true)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(glEyes, compute32_apart, Backend::compute32, false)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(glEyes, compute64_together, Backend::compute64, true)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(glEyes, compute64_apart, Backend::compute64, false)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(onGl, points, Backend::points)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace strata

BENCHMARK_MAIN();
