// Points a second of each rasterizer at 1920 x 1080. Not run by ctest: rasterizer_bench --benchmark_filter=...
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdlib>

#include "core/error.h"
#include "render/rasterizer.h"
#include "tests/support/synthetic_nodes.h"

namespace strata {
namespace {

constexpr double kPointsANode = 40000.0;

/// Points in millions: STRATA_BENCH_POINTS, else 10.
double millions() {
  const char* text = std::getenv("STRATA_BENCH_POINTS");
  return text == nullptr ? 10.0 : std::max(std::atof(text), 0.001);
}

const RenderList& town() {
  // A fifth of the points stands on the ground; a tile is two nodes, of which the upper one is small.
  static const RenderList list =
      test::makeTown(glm::dvec3(456789.0, 5412345.0, 300.0), 500.0, static_cast<std::uint32_t>(0.8e6 * millions()), 1,
                     std::max(1, static_cast<int>(std::sqrt(0.8e6 * millions() / kPointsANode))));
  return list;
}

View farView() {
  View view = viewOfBox(test::boundsOf(town()), {1.0, 0.83, -0.71}, 1920, 1080, 1.0);
  view.eye += (view.target - view.eye) * 0.5;
  return view;
}

View closeView() {
  View view = farView();
  view.eye = view.target + (view.eye - view.target) * 0.2;
  return view;
}

void draw(benchmark::State& state, Rasterizer& rasterizer, const View& view) {
  Frame frame;
  DrawStats total;
  for (int warm = 0; warm < 2; ++warm) rasterizer.draw(town(), view, {}, frame);
  for (auto _ : state) {
    const DrawStats stats = rasterizer.draw(town(), view, {}, frame);
    total.pointsDrawn += stats.pointsDrawn;
    total.uploadMs += stats.uploadMs;
    total.drawMs += stats.drawMs;
    total.resolveMs += stats.resolveMs;
  }
  const auto frames = static_cast<double>(state.iterations());
  state.counters["points"] = static_cast<double>(total.pointsDrawn) / frames;
  state.counters["Mpoints/s"] = static_cast<double>(total.pointsDrawn) / (1000.0 * (total.uploadMs + total.drawMs));
  state.counters["draw_ms"] = total.drawMs / frames;
  state.counters["resolve_ms"] = total.resolveMs / frames;
}

void cpu(benchmark::State& state, const View& view) {
  RasterizerOptions options;
  options.threads = static_cast<int>(state.range(0));
  draw(state, *createRasterizer(Backend::cpu, options, nullptr), view);
}

void onGl(benchmark::State& state, Backend backend) {
  RasterizerOptions options;
  options.uploadBytesPerFrame = options.gpuBytes;
  try {
    draw(state, *createRasterizer(backend, options, createHeadlessContext()), farView());
  } catch (const Error& error) {
    state.SkipWithError(error.what());
  }
}

BENCHMARK_CAPTURE(cpu, far, farView())->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(cpu, close, closeView())->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(onGl, compute32, Backend::compute32)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(onGl, points, Backend::points)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace strata

BENCHMARK_MAIN();
