// Measures what streaming costs and saves, for the tables of docs/benchmarks/streaming.md. Table 3 of Kanzok 2015 comes
// from paper_suites --suite kanzok. Usage:
//
//   streaming_bench indoors STORE [VIEWS]
//       random views from inside a store of synthetic:room, with and without occlusion
//   streaming_bench slow STORE PATH.json
//       frame times of a flight over an instant, a slow and a broken disk, and of its pictures over the first two
//   streaming_bench ahead STORE PATH.json
//       the same flight from a slow disk, with and without looking ahead
//   streaming_bench planes STORE PATH.json
//       bytes read by need and in full
//   streaming_bench loaders STORE
//       the loaders' speed against plain reading
//   streaming_bench open [NODES]
//       opening a store of so many nodes
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <functional>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "core/error.h"
#include "core/percentile.h"
#include "io/store/store_files.h"
#include "io/synthetic/scanner.h"
#include "io/synthetic/scenes.h"
#include "lod/streamer.h"
#include "render/create_rasterizer.h"
#include "tests/bench/troubled_disk.h"
#include "viewer/bench/measures.h"
#include "viewer/camera/camera_path.h"
#include "viewer/session/draw_defaults.h"
#include "viewer/session/picture_size.h"
#include "viewer/session/program_rasterizer.h"

namespace strata {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr PictureSize kPicture{1280, 720};
constexpr double kAheadSeconds = 0.5;

double msSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

struct Flight {
  std::vector<double> frameMs;
  double missing = 0.0;  ///< mean share of the wanted nodes that a frame had to do without
  int wholeFrames = 0;   ///< frames that lacked nothing
  double lastDetailMs = 0.0;
  StreamerStats stats;

  double percent(double p) const { return percentile(frameMs, p); }
};

/// The camera `t` seconds after the beginning of the path; it stays at the end.
View viewOn(const CameraPath& path, double t) {
  return viewAt(path, path.keys.front().t + std::clamp(t, 0.0, path.duration()), kPicture.width, kPicture.height);
}

/// Flies in real time; the first view is whole before the disk's troubles begin. Frames show what the streamer has, or
/// `shown`, one list a frame.
Flight fly(const TroubledStore& opened, const CameraPath& path, const StreamerOptions& options, bool ahead,
           const std::vector<RenderList>* shown = nullptr) {
  const StoreInfo& info = opened.store->info();
  const DrawOptions draw = drawOptionsFor(info, info.bounds, std::nullopt);
  const std::unique_ptr<Rasterizer> rasterizer = createWindowlessRasterizer(Backend::cpu);
  Streamer streamer(opened.store, options);
  streamer.setView(viewOn(path, 0.0));
  streamer.waitUntilComplete(120s);
  opened.disk->begin();
  Flight flight;
  Picture frame;
  auto start = Clock::now();
  for (int i = 0; i < path.frames(); ++i) {
    const double t = i / path.fps;
    std::this_thread::sleep_until(start +
                                  std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(t)));
    const auto began = Clock::now();
    const View now = viewOn(path, t);
    if (ahead)
      streamer.setView(now, viewOn(path, t + kAheadSeconds));
    else
      streamer.setView(now);
    const RenderList& list = streamer.beginFrame();
    rasterizer->draw(shown != nullptr ? (*shown)[static_cast<std::size_t>(i)] : list, now, draw, frame);
    flight.frameMs.push_back(msSince(began));
    const double wanted = static_cast<double>(list.items.size()) + list.missingNodes;
    flight.missing += wanted > 0.0 ? list.missingNodes / wanted : 0.0;
    flight.wholeFrames += list.missingNodes == 0 ? 1 : 0;
  }
  flight.missing /= path.frames();
  start = Clock::now();
  if (shown == nullptr) streamer.waitUntilComplete(120s);
  flight.lastDetailMs = msSince(start);
  flight.stats = streamer.stats();
  return flight;
}

/// Stops at each frame until it lacks nothing; visit(list).
template <typename Visit>
StreamerStats flyWhole(const std::string& store, const CameraPath& path, const StreamerOptions& options, Visit visit) {
  Streamer streamer(std::make_shared<const Store>(store), options);
  for (int i = 0; i < path.frames(); ++i) {
    streamer.setView(viewOn(path, i / path.fps));
    streamer.waitUntilComplete(120s);
    visit(streamer.beginFrame());
  }
  return streamer.stats();
}

// --- occlusion

struct Complete {
  double ms = 0.0, frameMs = 0.0;
  std::size_t nodes = 0;
  std::uint64_t points = 0;
  StreamerStats stats;
};

Complete complete(const std::string& storePath, const View& view, bool occlusion) {
  const auto store = std::make_shared<const Store>(storePath);
  StreamerOptions options;
  options.selection.occlusion.enabled = occlusion;
  options.cacheBytes = std::uint64_t{4} << 30;
  options.selection.pointBudget = SelectionOptions::kMaxPointBudget;
  const std::unique_ptr<Rasterizer> rasterizer = createWindowlessRasterizer(Backend::cpu);
  const DrawOptions draw = drawOptionsFor(store->info(), store->info().bounds, std::nullopt);
  Streamer streamer(store, options);
  Complete result;
  const auto start = Clock::now();
  streamer.setView(view);
  streamer.waitUntilComplete(300s);
  result.ms = msSince(start);
  const RenderList& list = streamer.beginFrame();
  result.nodes = list.items.size();
  result.points = list.pointCount;
  std::vector<double> times;
  Picture frame;
  for (int i = 0; i < 7; ++i) {
    const auto began = Clock::now();
    rasterizer->draw(list, view, draw, frame);
    times.push_back(msSince(began));
  }
  result.frameMs = percentile(times, 50.0);
  result.stats = streamer.stats();
  return result;
}

/// Views of people who look around in the rooms and the corridor.
void indoors(const std::string& storePath, int views) {
  const Store store(storePath);
  const Box bounds = store.info().bounds;
  const std::unique_ptr<synthetic::ScannerScan> scan = synthetic::makeRoom(store.info().points, 1);
  const glm::dvec3 origin = scan->extent().origin;
  std::mt19937_64 engine(5);
  const auto random = [&engine](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine);
  };
  Complete sum[2];
  int halved = 0;
  for (int i = 0; i < views; ++i) {
    View view;
    do {
      view.eye = {random(bounds.min.x, bounds.max.x), random(bounds.min.y, bounds.max.y), origin.z + random(1.2, 1.9)};
    } while (!scan->scene().isFree(glm::vec3(view.eye - origin), 0.3f));
    const double around = random(0.0, 6.2831853);
    view.target = view.eye + glm::dvec3(std::cos(around), std::sin(around), random(-0.4, 0.2));
    view.width = kPicture.width;
    view.height = kPicture.height;
    std::uint64_t loaded[2];
    for (const bool on : {false, true}) {
      const Complete c = complete(storePath, view, on);
      loaded[on] = c.stats.nodesLoaded;
      Complete& all = sum[on];
      all.stats.nodesLoaded += c.stats.nodesLoaded;
      all.stats.bytesRead += c.stats.bytesRead;
      all.nodes += c.nodes;
      all.points += c.points;
      all.frameMs += c.frameMs / views;
      all.stats.lodMsMean += c.stats.lodMsMean / views;
    }
    halved += 2 * loaded[1] <= loaded[0] ? 1 : 0;
  }
  std::printf("| %d views | nodes drawn | points | frame ms | nodes loaded | MB read | LOD ms |\n", views);
  std::printf("|---|---|---|---|---|---|---|\n");
  for (const bool on : {true, false})
    std::printf("| %s | %zu | %.1f M | %.1f | %llu | %.0f | %.2f |\n", on ? "with" : "without", sum[on].nodes,
                1e-6 * static_cast<double>(sum[on].points), sum[on].frameMs,
                static_cast<unsigned long long>(sum[on].stats.nodesLoaded),
                1e-6 * static_cast<double>(sum[on].stats.bytesRead), sum[on].stats.lodMsMean);
  std::printf("\n%.1f %% of the nodes loaded; at most half of them in %d of %d views\n",
              100.0 * static_cast<double>(sum[1].stats.nodesLoaded) / static_cast<double>(sum[0].stats.nodesLoaded),
              halved, views);
}

// --- flights

void printFlight(const char* name, const Flight& f) {
  std::printf("| %s | %.1f | %.1f | %.1f | %.2f %% | %d of %zu | %.0f | %.1f | %llu | %llu | %llu |\n", name,
              f.percent(50), f.percent(99), f.percent(100), 100.0 * f.missing, f.wholeFrames, f.frameMs.size(),
              f.lastDetailMs, 1e-6 * static_cast<double>(f.stats.bytesRead),
              static_cast<unsigned long long>(f.stats.nodesLoaded), static_cast<unsigned long long>(f.stats.failures),
              static_cast<unsigned long long>(f.stats.nodesGivenUp));
}

void printFlightHead() {
  std::printf(
      "| disk | p50 ms | p99 ms | max ms | nodes missing | whole frames | whole at the end after ms | MB read | "
      "nodes loaded | failures | given up |\n|---|---|---|---|---|---|---|---|---|---|---|\n");
}

/// Picture times of the same pictures while a streamer is at work behind them with either disk: with lists of their own
/// frames over the slow disk would be quicker, because less of what they want is there to be drawn.
void samePictures(const std::string& store, const CameraPath& path) {
  constexpr int kRounds = 5;
  std::vector<RenderList> lists;
  flyWhole(store, path, {}, [&](const RenderList& list) { lists.push_back(list); });
  const std::pair<const char*, TroubledDisk::Trouble> disks[] = {{"instant", {}},
                                                                 {"200 ms a read", {.latency = 200ms}}};
  std::vector<double> p50[2], p99[2], most[2], ratio;
  for (int round = 0; round < kRounds; ++round) {
    for (const std::size_t i : {round % 2, 1 - round % 2}) {  // each is first as often as last
      const Flight flight = fly(openWith(store, disks[i].second), path, {}, false, &lists);
      p50[i].push_back(flight.percent(50));
      p99[i].push_back(flight.percent(99));
      most[i].push_back(flight.percent(100));
    }
    ratio.push_back(p99[1].back() / p99[0].back());
  }
  std::printf("| disk | p50 ms | p99 ms | max ms |\n|---|---|---|---|\n");
  for (std::size_t i = 0; i < 2; ++i)
    std::printf("| %s, same pictures | %.1f | %.1f | %.1f |\n", disks[i].first, percentile(p50[i], 50),
                percentile(p99[i], 50), percentile(most[i], 50));
  std::printf("\nMedians of %d flights each, in turns. p99 over the slow disk / instant: %.2f (%.2f to %.2f)\n\n",
              kRounds, percentile(ratio, 50), percentile(ratio, 0), percentile(ratio, 100));
}

void slow(const std::string& store, const CameraPath& path) {
  samePictures(store, path);
  printFlightHead();
  printFlight("instant", fly(openWith(store, {}), path, {}, false));
  printFlight("200 ms a read", fly(openWith(store, {.latency = 200ms}), path, {}, false));
  StreamerOptions four;
  four.loaderThreads = 4;
  printFlight("200 ms a read, 4 loaders", fly(openWith(store, {.latency = 200ms}), path, four, false));
  printFlight("10 % of reads fail", fly(openWith(store, {.failing = 0.1}), path, {}, false));
  printFlight("10 % of reads are garbage", fly(openWith(store, {.garbage = 0.1}), path, {}, false));
}

void ahead(const std::string& store, const CameraPath& path) {
  printFlightHead();
  for (const auto latency : {5ms, 20ms, 50ms}) {
    for (const bool on : {false, true}) {
      const std::string name = std::to_string(latency.count()) + " ms a read" + (on ? ", looking ahead" : "");
      printFlight(name.c_str(), fly(openWith(store, {.latency = latency, .bytesPerSecond = 200e6}), path, {}, on));
    }
  }
}

/// Each frame is whole before the next, so that bytes do not hang on the machine's speed.
void planes(const std::string& store, const CameraPath& path) {
  std::printf("| read | MB, neighbours together | MB, each node alone |\n|---|---|---|\n");
  StreamerOptions full, need, shown;
  full.leastPrecision = Precision::full30;
  shown.selection.shown.colour = ColourMode::rgb;
  const std::pair<const char*, StreamerOptions*> ways[] = {
      {"all planes", &full}, {"precision by need", &need}, {"and only the colour", &shown}};
  for (const auto& [name, options] : ways) {
    std::printf("| %s |", name);
    for (const bool alone : {false, true}) {  // without the gaps that are read to save a read
      options->together.bytes = alone ? 0 : ReadLimits{}.bytes;
      const StreamerStats stats = flyWhole(store, path, *options, [](const RenderList&) {});
      std::printf(" %.1f |", 1e-6 * static_cast<double>(stats.bytesRead));
    }
    std::printf("\n");
  }
}

// --- the loader

/// Everything, most urgent first, over and over nothing: how fast the loaders alone are.
void loaders(const std::string& storePath) {
  const std::string file = storePath + "/" + kPointsFile;
  const auto plain = [&file] {
    const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
    std::vector<std::byte> buffer(std::size_t{1} << 20);
    const auto start = Clock::now();
    std::uint64_t bytes = 0;
    for (ssize_t got = 0; (got = ::read(descriptor, buffer.data(), buffer.size())) > 0;)
      bytes += static_cast<std::uint64_t>(got);
    ::close(descriptor);
    return 1e-6 * static_cast<double>(bytes) / (1e-3 * msSince(start));
  };
  plain();
  std::printf("| what | MB/s | M points/s |\n|---|---|---|\n| plain sequential reading | %.0f | |\n", plain());
  for (const bool occluders : {false, true}) {
    for (const int threads : {1, 2, 4}) {
      const auto store = std::make_shared<const Store>(storePath);
      StreamerOptions options;
      options.loaderThreads = threads;
      options.cacheBytes = std::uint64_t{8} << 30;
      options.leastPrecision = Precision::full30;
      options.selection.pointsPerPixel = 1e9;
      options.selection.minimumPixels = 0.0;
      options.selection.pointBudget = SelectionOptions::kMaxPointBudget;
      options.selection.occlusion = {.enabled = occluders, .gapPixels = 0.0, .openGapPixels = 0.0};
      Streamer streamer(store, options);
      const auto start = Clock::now();
      streamer.setView(viewOfBox(store->info().bounds, {0.3, 0.4, -1.0}, 1280, 720, 1.0));
      streamer.waitUntilComplete(120s);
      const double seconds = 1e-3 * msSince(start);
      std::printf("| %d loader%s%s | %.0f | %.1f |\n", threads, threads > 1 ? "s" : "",
                  occluders ? ", finding occluders" : "",
                  1e-6 * static_cast<double>(streamer.stats().bytesRead) / seconds,
                  1e-6 * static_cast<double>(streamer.beginFrame().pointCount) / seconds);
    }
  }
}

// --- opening

/// A full quadtree over flat ground, without payloads.
void openLarge(std::uint64_t wanted) {
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "strata-open-bench.strata";
  std::filesystem::create_directories(folder);
  StoreInfo info;
  info.program = "streaming_bench";
  info.cubeBits = 24;
  info.layout = PointLayout(std::vector<Attribute>{});
  info.bounds = info.rootCube();
  Hierarchy hierarchy;
  std::vector<NodeKey> keys{NodeKey{}};
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const Box cube = nodeCube(keys[i], info.rootCube());
    NodeRecord record{};
    record.key = keys[i].code;
    record.contourClass = static_cast<std::uint8_t>(ContourClass::planar);
    record.prefixes = 1;
    record.spacing = static_cast<float>(cube.size().x / 100.0);
    for (int axis = 0; axis < 3; ++axis) {
      record.centre[axis] = cube.centre()[axis];
      record.halfAxis[axis][axis] = static_cast<float>(cube.size()[axis] / (axis == 2 ? 100.0 : 2.0));
    }
    record.offset = sizeof(PointsHeader);
    if (keys.size() + 4 <= wanted && keys[i].level() < 12) {
      record.firstChild = static_cast<std::uint32_t>(keys.size());
      for (const int octant : {0, 2, 4, 6}) {
        record.childMask = static_cast<std::uint8_t>(record.childMask | 1 << octant);
        keys.push_back(keys[i].child(octant));
      }
    }
    info.levels = std::max(info.levels, keys[i].level() + 1);
    hierarchy.nodes.push_back(record);
  }
  info.nodes = hierarchy.nodes.size();
  {
    std::FILE* points = std::fopen((folder / kPointsFile).c_str(), "wb");
    const PointsHeader header = pointsHeader();
    std::fwrite(&header, sizeof header, 1, points);
    std::fclose(points);
  }
  writeStoreFiles(folder.string(), info, hierarchy, sizeof(PointsHeader));
  std::printf("| nodes | opening ms | index for streaming ms |\n|---|---|---|\n");
  for (int i = 0; i < 3; ++i) {
    auto start = Clock::now();
    const Store store(folder.string());
    const double openMs = msSince(start);
    start = Clock::now();
    const HierarchyIndex index = indexHierarchy(store.hierarchy());
    std::printf("| %zu | %.0f | %.0f |\n", index.parent.size(), openMs, msSince(start));
  }
  std::filesystem::remove_all(folder);
}

int run(const std::vector<std::string>& arguments) {
  const std::string what = arguments.empty() ? "" : arguments[0];
  if (what == "open") {
    openLarge(arguments.size() > 1 ? std::stoull(arguments[1]) : 2'000'000);
  } else if (what == "indoors" && arguments.size() >= 2) {
    indoors(arguments[1], arguments.size() > 2 ? std::stoi(arguments[2]) : 60);
  } else if (what == "loaders" && arguments.size() == 2) {
    loaders(arguments[1]);
  } else if (arguments.size() == 3) {
    const CameraPath path = readCameraPath(arguments[2]);
    if (what == "slow") slow(arguments[1], path);
    if (what == "ahead") ahead(arguments[1], path);
    if (what == "planes") planes(arguments[1], path);
  } else {
    std::fprintf(stderr, "error: see the head of tests/bench/streaming_bench.cpp\n");
    return 2;
  }
  return 0;
}

}  // namespace
}  // namespace strata

int main(int argc, char** argv) {
  try {
    return strata::run({argv + 1, argv + argc});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 1;
  }
}
