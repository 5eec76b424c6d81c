// One LOD pass, about 1000 nodes out of about 100,000 (target: 3 ms, goal 1 ms, on one core), and its selection alone.
#include <benchmark/benchmark.h>

#include <set>

#include "lod/hierarchy_index.h"
#include "lod/lod_pass.h"
#include "lod/selection.h"
#include "tests/support/lod_store.h"
#include "tests/support/lod_town.h"

namespace strata {
namespace {

const test::Terrain& terrain() {
  static const test::Terrain made =
      test::makeTerrain({.levels = 9, .side = 128, .cubeBits = 22}, false);  // 87,381 nodes
  return made;
}

/// The argument is the wanted points per pixel; the number of nodes follows from it.
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
    selectNodes({terrain().hierarchy, index.reach}, view, options, selection);
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

// --- the whole pass, everything in memory

/// A town of 100,001 nodes, with the points of those that the views here want.
struct LoadedTown {
  test::Town town{100'001};
  HierarchyIndex index = indexHierarchy(town.hierarchy);
  Store store{town.info, town.hierarchy, std::make_unique<test::MemoryBytes>(std::vector<std::byte>{})};
  NodeCache cache{std::uint64_t{8} << 30, index.parent};

  void load(const View& view, const SelectionOptions& options) {
    Selection selection;
    selectNodes({town.hierarchy, index.reach}, view, options, selection);
    std::vector<NodeCache::Released> released;
    for (const SelectedNode& selected : selection.nodes)
      if (!cache.contains(selected.node)) cache.insert(selected.node, town.load(selected.node), released);
  }
};

LoadedTown& loadedTown() {
  static LoadedTown loaded;
  return loaded;
}

/// Arguments: metres above the street; wanted points per pixel, in tenths.
void pass(benchmark::State& state, bool occlusion) {
  constexpr double kStep = 0.05, kWay = 5.0;  // metres, there and back
  LoadedTown& loaded = loadedTown();
  const auto height = static_cast<double>(state.range(0));
  LodTask task;
  task.selection.occlusion.enabled = occlusion;
  task.selection.pointBudget = SelectionOptions::kMaxPointBudget;
  task.selection.pointsPerPixel = 0.1 * static_cast<double>(state.range(1));
  for (double metres = 0.0; metres <= kWay + 1.0; metres += 1.0)
    loaded.load(loaded.town.along(metres, height), task.selection);

  DepthBuffers depth;
  LodPass lod(loaded.store, loaded.index, Precision::low10, loaded.cache, depth);
  const FailedNodes failed(std::chrono::milliseconds{250});
  LodOutput out;
  std::vector<NodeCache::Released> released;
  LodPass::Result result;
  std::uint64_t passes = 0, nodes = 0;
  const auto run = [&](double metres) {
    task.view = loaded.town.along(metres, height);
    result = lod.run(task, failed, Fade::Time::clock::now(), out, nullptr);
    nodes = out.pinned.list.items.size();
    out.pinned.list.items.clear();
    loaded.cache.unpin(out.pinned.pins, released);
    out.pinned.pins.clear();
  };
  run(0.0);  // the first one has nothing that could hide anything
  for (auto _ : state) run(kStep * std::abs(static_cast<double>(++passes % 200) - 100.0));
  state.counters["nodes"] = static_cast<double>(nodes);
  state.counters["hidden"] = static_cast<double>(result.occluded);
  state.counters["occluders"] = static_cast<double>(result.occluders);
  state.counters["missing"] = static_cast<double>(result.requests);
}
void passWithOcclusion(benchmark::State& state) { pass(state, true); }
void passWithout(benchmark::State& state) { pass(state, false); }

BENCHMARK(passWithOcclusion)
    ->Args({2, 18})
    ->Args({2, 200})
    ->Args({8, 80})
    ->Args({20, 20})
    ->Args({60, 20})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(passWithout)->Args({20, 20})->Unit(benchmark::kMillisecond);

void indexOfTheHierarchy(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(indexHierarchy(terrain().hierarchy));
}
BENCHMARK(indexOfTheHierarchy)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace strata

BENCHMARK_MAIN();
