// One LOD pass's selection: about 1000 nodes out of about 100,000 (target: 3 ms, goal 1 ms, on one core).
#include <benchmark/benchmark.h>

#include "lod/hierarchy_index.h"
#include "lod/selection.h"
#include "tests/support/lod_store.h"

namespace strata {
namespace {

const test::Terrain& terrain() {
  static const test::Terrain made =
      test::makeTerrain({.levels = 9, .side = 128, .cubeBits = 22}, false);  // 87,381 nodes
  return made;
}

/// The argument is the wanted points a pixel; the number of nodes goes with it.
void selectFromTerrain(benchmark::State& state, double height, std::uint64_t budget = std::uint64_t{1} << 31) {
  const HierarchyIndex index = indexHierarchy(terrain().hierarchy);
  View view = test::viewOfTerrain(terrain().info, 0.5, 0.1, height, 1920, 1080);
  view.target = view.eye + glm::dvec3(0.0, height, -0.4 * height);  // towards the horizon
  SelectionOptions options;
  options.pointBudget = budget;
  options.pointsPerPixel = static_cast<double>(state.range(0));
  Selection selection;
  for (auto _ : state) {
    view.eye.x += 0.01;
    view.target.x += 0.01;
    selectNodes(terrain().hierarchy, index.reach, view, options, selection);
    benchmark::DoNotOptimize(selection.nodes.data());
  }
  state.counters["nodes"] = static_cast<double>(selection.nodes.size());
  state.counters["tested"] = static_cast<double>(selection.tested);
  state.counters["Mpoints"] = 1e-6 * static_cast<double>(selection.pointCount);
}
void overTheGround(benchmark::State& state) { selectFromTerrain(state, 60.0); }
void highAbove(benchmark::State& state) { selectFromTerrain(state, 1000.0); }
void withinABudget(benchmark::State& state) { selectFromTerrain(state, 60.0, 5'000'000); }

BENCHMARK(overTheGround)->Arg(1)->Arg(2)->Arg(4)->Arg(16)->Unit(benchmark::kMicrosecond);
BENCHMARK(withinABudget)->Arg(4)->Arg(16)->Unit(benchmark::kMicrosecond);
BENCHMARK(highAbove)->Arg(1)->Arg(4)->Arg(16)->Unit(benchmark::kMicrosecond);

void indexOfTheHierarchy(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(indexHierarchy(terrain().hierarchy));
}
BENCHMARK(indexOfTheHierarchy)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace strata

BENCHMARK_MAIN();
