// Schütz 2022, Tables 1 to 3, 4.2 and 4.4.2, and Günther 2013, Figure 3 and
// Table 1, with made clouds of their sizes. Times are OpenGL's own (timestamp
// queries): clearing, culling and drawing, without reading the picture back.
// Run by gpu.sh. --small: clouds of a few 100 000 points, so that it is quick
// without a GPU; --medium: a twentieth of the papers' numbers. --order: the
// table of the points' order alone.
#include <algorithm>
#include <cstdio>
#include <numeric>
#include <random>
#include <string>

#include "core/error.h"
#include "render/compute_rasterizer.h"
#include "render/gl_objects.h"
#include "tests/bench/bench_clouds.h"
#include "tests/support/gl_contexts.h"
#include "tests/support/synthetic_nodes.h"

namespace strata::bench {
namespace {

constexpr double kLodPx = 100.0;  ///< nodes seen smaller than this are left out (Schütz 2022, 3.5)
constexpr std::uint32_t kLodNodePoints = 20480;

struct Scale {
  std::uint64_t divisor = 1;  ///< of the papers' numbers of points
  int width = 2560, height = 1140;
  int frames = 30;  ///< of a median
  std::uint32_t nodePoints = 50 * Batch::kMaxPoints;

  std::uint64_t points(double millions) const { return static_cast<std::uint64_t>(millions * 1e6) / divisor; }
  View sized(View view) const {
    view.width = width;
    view.height = height;
    return view;
  }
};

struct Measure {
  double ms = 0.0;
  DrawStats stats;
};

/// Median time of the GPU over some frames, when all is uploaded.
Measure measure(Rasterizer& rasterizer, const RenderList& list, const View& view, const DrawOptions& options,
                int frames) {
  Frame frame;
  Measure result;
  do {
    result.stats = rasterizer.draw(list, view, options, frame);
  } while (result.stats.nodesNotUploaded > 0 && result.stats.bytesUploaded > 0);
  std::vector<double> times;
  for (int i = 0; i < frames; ++i) times.push_back(rasterizer.draw(list, view, options, frame).gpuMs);
  std::nth_element(times.begin(), times.begin() + frames / 2, times.end());
  result.ms = times[static_cast<std::size_t>(frames / 2)];
  if (result.stats.nodesNotUploaded > 0) std::printf("(%u nodes do not fit)\n", result.stats.nodesNotUploaded);
  return result;
}

RasterizerOptions roomFor(const RenderList& list) {
  RasterizerOptions options;
  options.gpuBytes = list.pointCount * 17 + list.items.size() * 4096 + (std::uint64_t{256} << 20);
  options.uploadBytesPerFrame = std::uint64_t{4} << 30;
  return options;
}

ComputeWay fastestWay() {
  return hasWideAtomics(*createHeadlessContext()) ? ComputeWay::compute64 : ComputeWay::compute32;
}

double gpuMs(const RenderList& list, const View& view, const ComputeExperiment& experiment, bool blend, bool lod,
             const Scale& scale, DrawStats* stats = nullptr) {
  const auto rasterizer = createComputeRasterizer(fastestWay(), createHeadlessContext(), roomFor(list), experiment);
  DrawOptions options;
  options.shading = blend ? Shading::highQuality : Shading::plain;
  options.gaze = {lod, {0.5f, 0.5f}, static_cast<float>(kLodPx), static_cast<float>(kLodPx)};
  const Measure result = measure(*rasterizer, list, view, options, scale.frames);
  if (stats != nullptr) *stats = result.stats;
  return result.ms;
}

double pointsMs(const RenderList& list, const View& view, const Scale& scale) {
  const auto rasterizer = createRasterizer(Backend::points, roomFor(list), createHeadlessContext());
  return measure(*rasterizer, list, view, {}, std::max(scale.frames / 5, 1)).ms;
}

std::uint64_t batchesOf(const RenderList& list) {
  return std::accumulate(list.items.begin(), list.items.end(), std::uint64_t{0},
                         [](std::uint64_t sum, const RenderItem& item) { return sum + item.node->batches.size(); });
}

/// Bytes read and written a second by glCopyBufferSubData.
double copyBandwidth(const Scale& scale) {
  const auto context = createHeadlessContext();
  const GlFunctions gl = loadGlFunctions(*context);
  const auto copy = reinterpret_cast<void (*)(unsigned, unsigned, std::ptrdiff_t, std::ptrdiff_t, std::ptrdiff_t)>(
      context->getProc("glCopyBufferSubData"));
  const std::uint64_t bytes = (std::uint64_t{1} << 30) / std::min<std::uint64_t>(scale.divisor, 16);
  const GlBuffer from(gl, bytes, gl::kStaticDraw), to(gl, bytes, gl::kStaticDraw);
  const GlTimestamp begin(gl), end(gl);
  constexpr unsigned kCopyRead = 0x8F36, kCopyWrite = 0x8F37;
  gl.BindBuffer(kCopyRead, from.name());
  gl.BindBuffer(kCopyWrite, to.name());
  double best = 0.0;
  for (int i = 0; i < 10; ++i) {
    begin.record();
    copy(kCopyRead, kCopyWrite, 0, 0, static_cast<std::ptrdiff_t>(bytes));
    end.record();
    gl.Finish();
    best = std::max(best, 2.0 * static_cast<double>(bytes) / (static_cast<double>(end.value() - begin.value()) * 1e-9));
  }
  return best;
}

/// Schütz 2022, Tables 1 and 2, one cloud at a time.
void tables1And2(const Scale& scale, double bandwidth) {
  const Cloud ground69 = groundCloud("quarry", scale.points(69), 900.0);
  const Cloud ground279 = groundCloud("coast", scale.points(279), 5000.0);
  const Cloud temple = buildingCloud("temple", scale.points(529));
  const Cloud manor = buildingCloud("manor", scale.points(1000));
  struct Row {
    const Cloud& cloud;
    const char* where;
    View view;
  };
  const Row rows[] = {{ground69, "", ground69.outside},
                      {ground279, "", ground279.outside},
                      {temple, " (out)", temple.outside},
                      {temple, " (in)", temple.inside},
                      {manor, "", manor.outside}};
  std::printf(
      "\n## Table 1: milliseconds of the GPU, and Table 2: what was "
      "drawn (%d x %d)\n\n",
      scale.width, scale.height);
  std::printf(
      "| cloud | points | GL_POINTS | basic | prefetch | HQS | LOD "
      "basic | LOD HQS | G points/s (prefetch) | "
      "share of copy bandwidth | batches | drawn | points drawn | "
      "nodes LOD | batches drawn LOD | points drawn LOD "
      "|\n");
  std::printf("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const Row& row : rows) {
    const View view = scale.sized(row.view);
    ComputeExperiment basic;
    basic.prefetch = false;
    DrawStats whole, lod;
    double gl = 0.0, ms[5] = {};
    std::uint64_t batches = 0, nodes = 0;
    {
      const RenderList list = unstructured(row.cloud, scale.nodePoints);
      batches = batchesOf(list);
      gl = pointsMs(list, view, scale);
      ms[0] = fastestWay() == ComputeWay::compute64 ? gpuMs(list, view, basic, false, false, scale) : 0.0;
      ms[1] = gpuMs(list, view, {}, false, false, scale, &whole);
      ms[2] = gpuMs(list, view, {}, true, false, scale);
    }
    {
      const RenderList list = layered(row.cloud, kLodNodePoints);
      nodes = list.items.size();
      ms[3] = gpuMs(list, view, {}, false, true, scale, &lod);
      ms[4] = gpuMs(list, view, {}, true, true, scale);
    }
    const double rate = static_cast<double>(whole.pointsDrawn) / (ms[1] * 1e-3);
    std::printf(
        "| %s%s | %.1f M | %.2f | %.2f | %.2f | %.2f | %.2f | %.2f | "
        "%.3f | %.0f %% | %llu | %u | %.2f M | %llu | "
        "%u | %.2f M |\n",
        row.cloud.name.c_str(), row.where, static_cast<double>(row.cloud.count) * 1e-6, gl, ms[0], ms[1], ms[2], ms[3],
        ms[4], rate * 1e-9, 100.0 * 4.0 * rate / bandwidth, static_cast<unsigned long long>(batches),
        whole.batchesDrawn, static_cast<double>(whole.pointsDrawn) * 1e-6, static_cast<unsigned long long>(nodes),
        lod.batchesDrawn, static_cast<double>(lod.pointsDrawn) * 1e-6);
    std::fflush(stdout);
  }
}

/// Longest side of the tight boxes of the batches, as they would be without
/// rounding up to powers of two; metres.
double meanBatchSide(const RenderList& list) {
  double sum = 0.0;
  for (const RenderItem& item : list.items)
    for (const Batch& batch : item.node->batches) {
      Box box;
      for (std::uint32_t i = batch.firstPoint; i < batch.firstPoint + batch.pointCount; ++i)
        box.add(pointPosition(*item.node, batch, i, Precision::full30));
      const glm::dvec3 size = box.max - box.min;
      sum += std::max({size.x, size.y, size.z});
    }
  return sum / static_cast<double>(batchesOf(list));
}

/// Schütz 2022, 4.2 and Table 3: the file's order against Morton order, and
/// Hilbert's beside them.
void orderAndPrecision(const Scale& scale) {
  const Cloud clouds[] = {scannerCloud("scanner", scale.points(100)), buildingCloud("temple", scale.points(100)),
                          groundCloud("quarry", scale.points(69), 900.0)};
  std::printf("\n## 4.2 and Table 3: the order of points\n\n");
  std::printf(
      "| cloud | order | mean batch | view | ms | batches drawn | 10 "
      "bit | 20 bit | 30 bit |\n"
      "|---|---|---|---|---|---|---|---|---|\n");
  for (const Cloud& cloud : clouds)
    for (const char* order : {"file", "Morton", "Hilbert"}) {
      const RenderList list = order[0] == 'f'
                                  ? unstructured(cloud, scale.nodePoints)
                                  : sorted(cloud, order[0] == 'M' ? Curve::morton : Curve::hilbert, scale.nodePoints);
      const double side = meanBatchSide(list);
      for (const bool inside : {false, true}) {
        DrawStats stats;
        const double ms =
            gpuMs(list, scale.sized(inside ? cloud.inside : cloud.outside), {}, false, false, scale, &stats);
        std::printf("| %s | %s | %.2f m | %s | %.2f | %u | %u | %u | %u |\n", cloud.name.c_str(), order, side,
                    inside ? "inside" : "outside", ms, stats.batchesDrawn, stats.batchesAt[0], stats.batchesAt[1],
                    stats.batchesAt[2]);
        std::fflush(stdout);
      }
    }
}

/// Schütz 2022, 4.4.2: everything outside the image, nothing culled, with 10,
/// 20 and 30 bits.
void forcedPrecision(const Scale& scale) {
  const Cloud cloud = buildingCloud("temple", scale.points(529));
  const RenderList list = unstructured(cloud, scale.nodePoints);
  View away = scale.sized(cloud.outside);
  away.target = away.eye + (away.eye - away.target);
  std::printf(
      "\n## 4.4.2: %.1f M points, all outside the image, none "
      "culled\n\n| bits | ms |\n|---|---|\n",
      static_cast<double>(cloud.count) * 1e-6);
  for (const int planes : {1, 2, 3}) {
    ComputeExperiment experiment;
    experiment.forcedPlanes = planes;
    std::printf("| %d | %.2f |\n", 10 * planes, gpuMs(list, away, experiment, false, false, scale));
    std::fflush(stdout);
  }
}

/// `count` planes of side x side points, one behind the other, shuffled
/// (Günther 2013, 5.1).
RenderList planeStack(int side, int count, std::uint32_t nodePoints) {
  std::vector<glm::ivec3> cells;
  for (int z = 0; z < count; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) cells.emplace_back(x, y, z);
  std::shuffle(cells.begin(), cells.end(), std::mt19937(1));
  std::vector<std::shared_ptr<const NodeData>> nodes;
  for (std::size_t first = 0; first < cells.size(); first += nodePoints) {
    std::vector<glm::dvec3> points;
    for (std::size_t i = first; i < std::min(first + nodePoints, cells.size()); ++i)
      points.push_back((glm::dvec3(cells[i]) + glm::dvec3(0.5, 0.5, 1.0)) * 0.001);
    nodes.push_back(test::makeNode({}, points, 0.0005));
  }
  return test::makeList(nodes);
}

/// An orthographic view of the stack in which a plane's side is `pixels`.
View stackView(int side, int pixels) {
  View view;
  view.width = view.height = side;
  view.orthographic = true;
  view.orthographicHeight = 0.001 * side * side / pixels;
  view.eye = glm::dvec3(0.0005 * side, 0.0005 * side, -1.0);
  view.target = view.eye + glm::dvec3(0.0, 0.0, 1.0);
  view.up = glm::dvec3(0.0, -1.0, 0.0);
  return view;
}

void guentherFigure3(const Scale& scale) {
  const int side = scale.divisor > 1 ? 128 : 1024;
  const int most = scale.divisor > 1 ? 8 : 170;
  std::printf(
      "\n## Günther 2013, Figure 3: planes of %d x %d points, "
      "shuffled; milliseconds\n\n",
      side, side);
  std::printf(
      "| planes | covered pixels | GL_POINTS | compute_lock | "
      "compute32 | compute64 | retries | repairs |\n"
      "|---|---|---|---|---|---|---|---|\n");
  const auto row = [&](const RenderList& list, int planes, int pixels) {
    const View view = stackView(side, pixels);
    const auto ms = [&](ComputeWay way, DrawStats* stats) {
      const auto rasterizer = createComputeRasterizer(way, createHeadlessContext(), roomFor(list));
      const Measure result = measure(*rasterizer, list, view, {}, std::max(scale.frames / 3, 1));
      if (stats != nullptr) *stats = result.stats;
      return result.ms;
    };
    DrawStats stats;
    const double lock = ms(ComputeWay::computeLock, &stats), two = ms(ComputeWay::compute32, nullptr);
    const double wide = fastestWay() == ComputeWay::compute64 ? ms(ComputeWay::compute64, nullptr) : 0.0;
    std::printf("| %d | %d | %.2f | %.2f | %.2f | %.2f | %llu | %u |\n", planes, pixels * pixels,
                pointsMs(list, view, scale), lock, two, wide, static_cast<unsigned long long>(stats.lockRetries),
                stats.lockRepairs);
    std::fflush(stdout);
  };
  for (int planes = 1; planes < most; planes *= 2) row(planeStack(side, planes, scale.nodePoints), planes, side);
  const RenderList list = planeStack(side, most, scale.nodePoints);
  for (int pixels = side; pixels >= 1; pixels /= 4) row(list, most, pixels);
}

/// Günther 2013, Table 1: many depth tests with some culling (1, 2), much
/// culling (3), an overview (4).
void guentherTable1(const Scale& scale) {
  const Cloud cloud = buildingCloud("building", scale.points(138));
  const RenderList list = unstructured(cloud, scale.nodePoints);
  View inner = cloud.inside, corner = cloud.inside, overview = cloud.outside;
  corner.eye = {5.5, 5.5, 1.7};
  corner.target = {4.5, 4.2, 1.5};
  overview.eye *= 4.0;
  inner.target = {13.0, 40.0, 1.7};
  const std::pair<int, View> views[] = {{1, cloud.inside}, {2, inner}, {3, corner}, {4, overview}};
  std::printf(
      "\n## Günther 2013, Table 1: frames a second, %.1f M points "
      "(depth in clip space)\n\n",
      static_cast<double>(cloud.count) * 1e-6);
  std::printf(
      "| view | points after culling | GL_POINTS | compute_lock | "
      "ratio |\n|---|---|---|---|---|\n");
  for (const auto& [number, view] : views) {
    const auto lock = createComputeRasterizer(ComputeWay::computeLock, createHeadlessContext(), roomFor(list));
    const Measure result = measure(*lock, list, scale.sized(view), {}, scale.frames);
    const double gl = pointsMs(list, scale.sized(view), scale);
    std::printf("| %d | %.2f M | %.2f | %.2f | %.2f |\n", number, static_cast<double>(result.stats.pointsDrawn) * 1e-6,
                1e3 / gl, 1e3 / result.ms, gl / result.ms);
    std::fflush(stdout);
  }
}

/// Schütz 2022, 3.6 and 4.3: two eyes in one pass against two passes.
void twoEyes(const Scale& scale) {
  const Cloud cloud = buildingCloud("temple", scale.points(529));
  const RenderList list = layered(cloud, kLodNodePoints);
  View left = scale.sized(cloud.outside), right = left;
  right.eye += glm::dvec3(0.04, -0.04, 0.0);
  right.target += glm::dvec3(0.04, -0.04, 0.0);
  const View views[] = {left, right};
  const auto rasterizer = createComputeRasterizer(fastestWay(), createHeadlessContext(), roomFor(list));
  std::vector<double> together, apart;
  Frame frames[2];
  rasterizer->drawViews(list, views, {}, frames);
  for (int i = 0; i < scale.frames; ++i) {
    together.push_back(rasterizer->drawViews(list, views, {}, frames).gpuMs);
    apart.push_back(rasterizer->draw(list, left, {}, frames[0]).gpuMs +
                    rasterizer->draw(list, right, {}, frames[1]).gpuMs);
  }
  for (auto* times : {&together, &apart}) std::sort(times->begin(), times->end());
  std::printf(
      "\n## 4.3: two eyes\n\n| one pass | two passes |\n|---|---|\n| "
      "%.2f ms | %.2f ms |\n",
      together[together.size() / 2], apart[apart.size() / 2]);
}

int run(const std::string& size, const std::string& only) {
  Scale scale;
  if (size == "--small") scale = {1000, 320, 143, 3, 5 * Batch::kMaxPoints};
  if (size == "--medium") scale = {20, 1280, 570, 5, 10 * Batch::kMaxPoints};
  if (only == "--order") {
    orderAndPrecision(scale);
    return 0;
  }
  const auto context = createHeadlessContext();
  std::printf("# Rasterizers on %s\n\n", glRenderer(loadGlFunctions(*context)).c_str());
  const double bandwidth = copyBandwidth(scale);
  std::printf("Copying on the device reads and writes %.1f GB/s together. %s\n", bandwidth * 1e-9,
              fastestWay() == ComputeWay::compute64 ? "The compute columns are compute64."
                                                    : "No 64-bit atomics: the compute columns are compute32.");
  tables1And2(scale, bandwidth);
  orderAndPrecision(scale);
  forcedPrecision(scale);
  twoEyes(scale);
  guentherFigure3(scale);
  guentherTable1(scale);
  return 0;
}

}  // namespace
}  // namespace strata::bench

int main(int argc, char** argv) {
  const std::string size = argc > 1 ? argv[1] : "", only = argc > 2 ? argv[2] : "";
  if (argc > 3 || (argc > 1 && size != "--small" && size != "--medium") || (argc > 2 && only != "--order")) {
    std::fprintf(stderr, "usage: gpu_bench [--small|--medium [--order]]\n");
    return 2;
  }
  try {
    strata::test::offerWideAtomicsInSoftware();
    return strata::bench::run(size, only);
  } catch (const strata::Error& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 1;
  }
}
