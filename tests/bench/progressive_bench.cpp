// Measures progressive drawing as Rumpler 2019, 4.1, with a synthetic cloud of buildings at 1280 x 720. Prints tables
// of docs/benchmarks/progressive.md. The camera moves a little in each frame that is timed, so that no frame finds its
// picture finished.
//
// progressive_bench [--small | --points MILLION] [--pictures FOLDER]
//
// --small draws 300 000 points and takes a few seconds. --pictures writes pictures of a jump of the camera (4.2.2).
#include <algorithm>
#include <bit>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>

#include "core/error.h"
#include "core/image.h"
#include "render/create_rasterizer.h"
#include "render/progressive/progressive_rasterizer.h"
#include "render/stopwatch.h"
#include "tests/bench/suites/clouds.h"

namespace strata::bench {
namespace {

constexpr std::uint64_t kNoLimit = std::uint64_t{1} << 40;

struct Scale {
  std::uint64_t points = 10'000'000;
  int frames = 9;  ///< of a median
  int width = 1280, height = 720;
  std::string pictures;  ///< folder; empty = none
};

struct Scene {
  RenderList list;
  View view, away;
};

Scene makeScene(const Scale& scale) {
  const suite::Cloud cloud = suite::buildingCloud("buildings", scale.points);
  Scene scene{suite::layered(cloud, 65536), cloud.outside, cloud.outside};
  scene.view.width = scene.away.width = scale.width;
  scene.view.height = scene.away.height = scale.height;
  scene.away.target = scene.away.eye + (scene.away.eye - scene.away.target);
  return scene;
}

std::unique_ptr<ProgressiveRasterizer> progressive(std::uint64_t pointsPerFrame, std::uint64_t pool) {
  return createProgressiveRasterizer(createHeadlessContext(), {pointsPerFrame, kNoLimit, pool, 1});
}

/// Takes all that the view shows into the pool and draws until the picture is finished.
void fillPool(ProgressiveRasterizer& rasterizer, const RenderList& list, const View& view) {
  Picture picture;
  const ProgressiveOptions options = rasterizer.options();
  rasterizer.setOptions({kNoLimit, kNoLimit});
  while (!isFinished(rasterizer.draw(list, view, {}, picture))) {
  }
  rasterizer.setOptions(options);
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

struct Times {
  double frame, gpu, upload, clear, reproject, fill, index, keep, read, resolve;
};

/// Medians over the frames of a camera that moves slowly to the side. listOf(i) gives the nodes of frame i.
Times timeFrames(Rasterizer& rasterizer, const std::function<const RenderList&(int)>& listOf, View view, int frames) {
  const auto* const steps = dynamic_cast<const ProgressiveRasterizer*>(&rasterizer);
  std::vector<double> values[10];
  Picture picture;
  const glm::dvec3 step = 0.0005 * glm::distance(view.eye, view.target) * viewBasis(view).right;
  for (int i = -2; i < frames; ++i) {
    view.eye += step;
    view.target += step;
    Stopwatch watch;
    const DrawStats stats = rasterizer.draw(listOf(i + 2), view, {}, picture);
    const double ms = watch.lapMs();
    if (i < 0) continue;
    const ProgressiveStats p = steps != nullptr ? steps->progress() : ProgressiveStats{};
    const double all[] = {ms,       stats.gpuMs, stats.uploadMs, p.clearMs, p.reprojectMs,
                          p.fillMs, p.indexMs,   p.keepMs,       p.readMs,  stats.resolveMs};
    for (int k = 0; k < 10; ++k) values[k].push_back(all[k]);
  }
  double m[10];
  for (int k = 0; k < 10; ++k) m[k] = median(values[k]);
  return {m[0], m[1], m[2], m[3], m[4], m[5], m[6], m[7], m[8], m[9]};
}

Times timeFrames(Rasterizer& rasterizer, const RenderList& list, const View& view, int frames) {
  return timeFrames(
      rasterizer, [&list](int) -> const RenderList& { return list; }, view, frames);
}

double millions(std::uint64_t points) { return static_cast<double>(points) * 1e-6; }

void savePicture(const Scale& scale, const std::string& name, const Picture& picture) {
  if (!scale.pictures.empty())
    writePng(scale.pictures + "/" + name + ".png", {picture.width, picture.height, picture.colour});
}

/// The number of frames until shares of the pixels are final, after a jump of the camera to nodes that are in the pool.
void convergenceTable(const Scale& scale, const Scene& scene) {
  Picture wanted, picture;
  {
    RasterizerOptions room;
    room.uploadBytesPerFrame = kNoLimit;
    const auto plain = createRasterizer(Backend::compute32, room, createHeadlessContext());
    plain->draw(scene.list, scene.view, {}, wanted);
    savePicture(scale, "final", wanted);
  }
  std::printf("Frames until pixels are final after a jump of the camera, of %.1f M points in the pool:\n\n",
              millions(scene.list.pointCount));
  std::printf("| pool | a frame | turn | 90 %% | 99 %% | 100 %% |\n|---|---|---|---|---|---|\n");
  struct Way {
    std::uint64_t pool;
    std::vector<int> shares;
  };
  const std::uint64_t least = scene.list.pointCount * 11 / 10, square = std::bit_ceil(least);
  std::vector<Way> ways{{least, {5, 10, 20, 40}}, {2 * least, {20}}};
  if (!scale.pictures.empty()) ways.push_back({square, {20}});
  for (const Way& way : ways) {
    const auto rasterizer = progressive(kNoLimit, way.pool);
    for (const int share : way.shares) {
      fillPool(*rasterizer, scene.list, scene.view);
      rasterizer->draw(scene.list, scene.away, {}, picture);
      const std::uint64_t n = scene.list.pointCount / static_cast<std::uint64_t>(share);
      rasterizer->setOptions({n, kNoLimit});
      int reached[3] = {0, 0, 0};
      bool finished = false;
      for (int count = 1; !finished; ++count) {
        finished = isFinished(rasterizer->draw(scene.list, scene.view, {}, picture));
        std::size_t same = 0, all = 0;
        for (std::size_t i = 0; i < wanted.pointId.size(); ++i) {
          const bool covered = wanted.pointId[i] != Picture::kNoPoint;
          all += covered;
          same += covered && wanted.pointId[i] == picture.pointId[i];
        }
        const double part = static_cast<double>(same) / static_cast<double>(all);
        for (const int k : {0, 1, 2})
          if (reached[k] == 0 && part >= (k == 0 ? 0.9 : k == 1 ? 0.99 : 1.0)) reached[k] = count;
        if (share == 20 && way.pool == square && (count == 2 || count == 8))
          savePicture(scale, "keyed" + std::to_string(count), picture);
      }
      std::printf("| %.1f M | %.2f M | %.1f | %d | %d | %d |\n", millions(rasterizer->progress().poolPoints),
                  millions(n), static_cast<double>(rasterizer->progress().turnPlaces) / static_cast<double>(n),
                  reached[0], reached[1], reached[2]);
      std::fflush(stdout);
    }
  }
}

/// Figure 4.1 and Table 4.2: the times of the passes for growing numbers of new points.
void fillTable(const Scale& scale, const Scene& scene) {
  std::printf("\nThe passes over the points of a frame (Figure 4.1, Table 4.2), milliseconds:\n\n");
  std::printf("| a frame | frame | upload | clear | reproject | fill | index | keep | read back | resolve |\n");
  std::printf("|---|---|---|---|---|---|---|---|---|---|\n");
  const auto rasterizer = progressive(kNoLimit, scene.list.pointCount * 11 / 10);
  fillPool(*rasterizer, scene.list, scene.view);
  for (const int share : {100, 50, 20, 10, 5, 2, 1}) {
    const std::uint64_t n = scene.list.pointCount / static_cast<std::uint64_t>(share);
    rasterizer->setOptions({n, kNoLimit});
    const Times t = timeFrames(*rasterizer, scene.list, scene.view, scale.frames);
    std::printf("| %.2f M | %.1f | %.1f | %.1f | %.1f | %.1f | %.1f | %.1f | %.1f | %.1f |\n", millions(n), t.frame,
                t.upload, t.clear, t.reproject, t.fill, t.index, t.keep, t.read, t.resolve);
    std::fflush(stdout);
  }
}

/// Table 4.3: half of the points, in a pool without the other half; with the other half put in after it; and with it.
void halfFullTable(const Scale& scale, const Scene& scene) {
  RenderList half;
  for (std::size_t i = 0; i < scene.list.items.size(); i += 2) {
    half.items.push_back(scene.list.items[i]);
    half.pointCount += scene.list.items[i].pointCount;
  }
  const std::uint64_t pool = scene.list.pointCount * 11 / 10;
  std::printf("\nA whole turn in one frame (Table 4.3), pool of %.1f M places, %.1f M points shown:\n\n",
              millions(pool), millions(half.pointCount));
  std::printf("| the other half | pool | turn | fill, ms | frame, ms |\n|---|---|---|---|---|\n");
  const std::pair<const char*, std::vector<const RenderList*>> ways[] = {
      {"never seen", {&half}}, {"seen after it", {&half, &scene.list}}, {"seen with it", {&scene.list}}};
  for (const auto& [name, lists] : ways) {
    const auto rasterizer = progressive(pool, pool);
    for (const RenderList* before : lists) fillPool(*rasterizer, *before, scene.view);
    const ProgressiveStats& stats = rasterizer->progress();
    const double taken = 100.0 * (1.0 - static_cast<double>(stats.poolFree) / static_cast<double>(stats.poolPoints));
    const Times t = timeFrames(*rasterizer, half, scene.view, scale.frames);
    std::printf("| %s | %.0f %% full | %.1f M | %.1f | %.1f |\n", name, taken, millions(stats.turnPlaces), t.fill,
                t.frame);
    std::fflush(stdout);
  }
}

/// Table 4.4: a comparison with drawing everything in each frame.
void comparisonTable(const Scale& scale, const Scene& scene) {
  std::printf("\nAgainst drawing everything (Table 4.4), %.1f M points, %d x %d, milliseconds a frame:\n\n",
              millions(scene.list.pointCount), scale.width, scale.height);
  std::printf("| way | frame | drawing by OpenGL's clock |\n|---|---|---|\n");
  const auto row = [](const std::string& name, const Times& t) {
    std::printf("| %s | %.1f | %.1f |\n", name.c_str(), t.frame, t.gpu);
    std::fflush(stdout);
  };
  RasterizerOptions room;
  room.uploadBytesPerFrame = kNoLimit;
  for (const Backend backend : {Backend::points, Backend::compute32, Backend::cpu}) {
    const auto plain = createRasterizer(backend, room, backend == Backend::cpu ? nullptr : createHeadlessContext());
    const int frames = backend == Backend::points ? std::min(scale.frames, 3) : scale.frames;  // seconds each
    row("everything, " + std::string(plain->name()), timeFrames(*plain, scene.list, scene.view, frames));
  }
  const std::uint64_t pool = scene.list.pointCount * 11 / 10;
  const auto rasterizer = progressive(kNoLimit, pool);
  fillPool(*rasterizer, scene.list, scene.view);
  for (const int share : {1, 10, 20, 50}) {
    rasterizer->setOptions({pool / static_cast<std::uint64_t>(share), kNoLimit});
    char name[64];
    std::snprintf(name, sizeof name, "progressive, %.2f M a frame", millions(pool) / share);
    row(name, timeFrames(*rasterizer, scene.list, scene.view, scale.frames));
  }
  // Two lists take turns in a pool that cannot hold both, so the memory manager has work in each frame.
  RenderList lists[2];
  for (std::size_t i = 0; i < scene.list.items.size(); ++i) {
    lists[i % 2].items.push_back(scene.list.items[i]);
    lists[i % 2].pointCount += scene.list.items[i].pointCount;
  }
  const std::uint64_t n = pool / 20, small = std::max(lists[0].pointCount, lists[1].pointCount) * 11 / 10;
  const auto busy = progressive(n, small);
  busy->setOptions({n, n / 2});
  char name[96];
  std::snprintf(name, sizeof name, "progressive, %.2f M a frame, %.2f M written into a full pool", millions(n),
                millions(n / 2));
  row(name, timeFrames(
                *busy, [&](int i) -> const RenderList& { return lists[i / 20 % 2]; }, scene.view, 40 + scale.frames));
}

int run(const Scale& scale) {
  std::printf("Progressive drawing on %s.\n\n", progressive(1, 1000)->device().c_str());
  const Scene scene = makeScene(scale);
  convergenceTable(scale, scene);
  fillTable(scale, scene);
  halfFullTable(scale, scene);
  comparisonTable(scale, scene);
  return 0;
}

}  // namespace
}  // namespace strata::bench

int main(int argc, char** argv) {
  strata::bench::Scale scale;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--small") {
      scale = {300'000, 3, 320, 180, scale.pictures};
    } else if (argument == "--points" && i + 1 < argc) {
      scale.points = static_cast<std::uint64_t>(1e6 * std::atof(argv[++i]));
    } else if (argument == "--pictures" && i + 1 < argc) {
      scale.pictures = argv[++i];
    } else {
      std::fprintf(stderr, "usage: progressive_bench [--small | --points MILLION] [--pictures FOLDER]\n");
      return 2;
    }
  }
  try {
    return strata::bench::run(scale);
  } catch (const strata::Error& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 1;
  }
}
