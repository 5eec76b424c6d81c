// Schütz, Kerbl, Wimmer 2022: Tables 1 to 3, 4.2, 4.3 and 4.4.2.
#include <algorithm>
#include <cstdio>
#include <numeric>

#include "tests/bench/suites/clouds.h"
#include "tests/bench/suites/measure.h"
#include "tests/bench/suites/suites.h"

namespace strata::suite {
namespace {

constexpr double kLodPx = 100.0;  ///< nodes seen smaller than this are left out (3.5)
constexpr std::uint32_t kLodNodePoints = 20480;

std::uint64_t batchesOf(const RenderList& list) {
  return std::accumulate(list.items.begin(), list.items.end(), std::uint64_t{0},
                         [](std::uint64_t sum, const RenderItem& item) { return sum + item.node->batches.size(); });
}

Measure drawn(const Setup& setup, const RenderList& list, const View& view, bool blend, bool lod) {
  DrawOptions draw;
  draw.shading = blend ? Shading::highQuality : Shading::plain;
  draw.gaze = {lod, {0.5f, 0.5f}, static_cast<float>(kLodPx), static_cast<float>(kLodPx)};
  return measureOurs(setup, list, view, draw);
}

/// A row of Tables 1 and 2. The paper's figures are of its RTX 3090; points and batches in millions and thousands.
struct PaperRow {
  const char* name;
  double points, gl, basic, prefetch, hqs, lod, lodHqs;
  double batches, batchesDrawn, pointsDrawn, nodes, lodBatches, lodPoints;
};
constexpr PaperRow kPaper[] = {
    {"Eclepens", 69, 34.9, 1.1, 1.0, 2.8, 0.7, 1.4, 6.7, 6.7, 68.7, 23.5, 0.422, 3.9},
    {"Morro Bay", 279, 231.7, 2.7, 2.2, 9.6, 0.8, 1.9, 27.2, 27.2, 278.5, 93.5, 0.577, 5.6},
    {"Banyunibo (out)", 529, 198.3, 4.2, 3.3, 9.0, 1.3, 3.3, 51.7, 46.6, 477.6, 195.7, 3.3, 26.9},
    {"Banyunibo (in)", 529, 67.9, 2.6, 2.2, 6.1, 2.1, 4.6, 51.7, 20.9, 214.5, 195.7, 8.2, 67.1},
    {"Niederweiden", 1000, 873.9, 8.2, 6.4, 20.9, 1.9, 4.5, 97.7, 88.9, 910.7, 346.6, 2.1, 27.3}};

struct Row {
  std::vector<std::string> times, drawn;
};

Row measureRow(const Setup& setup, const std::string& name, const Cloud& cloud, const View& view) {
  const double points = static_cast<double>(cloud.count);
  Row row;
  std::optional<double> gl, basic;
  Measure whole, hqs, lod, lodHqs;
  std::uint64_t batches = 0, nodes = 0;
  {
    const RenderList list = unstructured(cloud, setup.nodePoints);
    batches = batchesOf(list);
    gl = pointsMs(setup, list, view);
    ComputeExperiment withoutPrefetch;
    withoutPrefetch.prefetch = false;
    if (setup.ours == "compute64") basic = measureWay(setup, ComputeWay::compute64, list, view, withoutPrefetch)->ms;
    whole = drawn(setup, list, view, false, false);
    hqs = drawn(setup, list, view, true, false);
  }
  {
    const RenderList list = layered(cloud, kLodNodePoints);
    nodes = list.items.size();
    lod = drawn(setup, list, view, false, true);
    lodHqs = drawn(setup, list, view, true, true);
  }
  const double rate = static_cast<double>(whole.stats.pointsDrawn) / (whole.ms * 1e-3);
  row.times = {name,
               count(points),
               number(gl, 1),
               number(basic, 1),
               number(whole.ms, 1),
               number(hqs.ms, 1),
               number(lod.ms, 1),
               number(lodHqs.ms, 1),
               number(rate * 1e-9, 3),
               gl ? number(*gl / whole.ms, 0) : "-"};
  row.drawn = {name,
               count(static_cast<double>(batches)),
               count(whole.stats.batchesDrawn),
               count(static_cast<double>(whole.stats.pointsDrawn)),
               count(static_cast<double>(nodes)),
               count(lod.stats.batchesDrawn),
               count(static_cast<double>(lod.stats.pointsDrawn))};
  return row;
}

Row paperRow(const PaperRow& p) {
  return {{std::string("*") + p.name + "*", count(p.points * 1e6), number(p.gl, 1), number(p.basic, 1),
           number(p.prefetch, 1), number(p.hqs, 1), number(p.lod, 1), number(p.lodHqs, 1),
           number(p.pointsDrawn / p.prefetch, 1), number(p.gl / p.prefetch, 0)},
          {std::string("*") + p.name + "*", count(p.batches * 1e3), count(p.batchesDrawn * 1e3),
           count(p.pointsDrawn * 1e6), count(p.nodes * 1e3), count(p.lodBatches * 1e3), count(p.lodPoints * 1e6)}};
}

void tables1And2(const Setup& setup) {
  std::vector<Row> rows;
  const auto add = [&](std::size_t paper, const std::string& name, const Cloud& cloud, const View& view) {
    rows.push_back(measureRow(setup, name, cloud, setup.sized(view)));
    rows.push_back(paperRow(kPaper[paper]));
  };
  {
    const Cloud quarry = groundCloud("quarry", setup.points(69), 900.0);
    add(0, "quarry", quarry, quarry.outside);
  }
  {
    const Cloud coast = groundCloud("coast", setup.points(279), 5000.0);
    add(1, "coast", coast, coast.outside);
  }
  {
    const Cloud temple = buildingCloud("temple", setup.points(529));
    add(2, "temple (out)", temple, temple.outside);
    add(3, "temple (in)", temple, temple.inside);
  }
  {
    const Cloud manor = buildingCloud("manor", setup.points(1000));
    add(4, "manor", manor, manor.outside);
  }
  std::printf("\nTable 1, milliseconds; the paper's rows in italics, by an RTX 3090 at 2560 x 1140.\n");
  printHeader({"cloud", "points", "GL_POINTS", "no prefetch", "whole", "whole, high quality", "LOD",
               "LOD, high quality", "G points/s, whole", "times GL_POINTS"});
  for (const Row& row : rows) printRow(row.times);
  std::printf("\nTable 2, what was processed.\n");
  printHeader({"cloud", "batches", "drawn", "points drawn", "LOD nodes", "drawn", "points drawn"});
  for (const Row& row : rows) printRow(row.drawn);
}

/// Longest side of the tight boxes of the batches, as they would be without rounding up to powers of two; metres.
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

/// 4.2 and Table 3: the file's order against Morton order, and Hilbert's beside them.
void orderAndPrecision(const Setup& setup) {
  std::printf("\n4.2 and Table 3: the order of points, milliseconds and batches by precision.\n");
  printHeader({"cloud", "order", "mean batch", "view", "ms", "batches drawn", "10 bit", "20 bit", "30 bit"});
  const Cloud clouds[] = {scannerCloud("scanner", setup.points(100)), groundCloud("quarry", setup.points(69), 900.0)};
  for (const Cloud& cloud : clouds)
    for (const char* order : {"file", "Morton", "Hilbert"}) {
      const RenderList list = order[0] == 'f'
                                  ? unstructured(cloud, setup.nodePoints)
                                  : sorted(cloud, order[0] == 'M' ? Curve::morton : Curve::hilbert, setup.nodePoints);
      const std::string side = number(meanBatchSide(list), 2) + " m";
      for (const bool inside : {false, true}) {
        const Measure m = measureOurs(setup, list, setup.sized(inside ? cloud.inside : cloud.outside));
        printRow({cloud.name, order, side, inside ? "close-up" : "overview", number(m.ms, 1),
                  std::to_string(m.stats.batchesDrawn), std::to_string(m.stats.batchesAt[0]),
                  std::to_string(m.stats.batchesAt[1]), std::to_string(m.stats.batchesAt[2])});
      }
    }
  printRow({"*Banyunibo*", "file", "9.3 m", "overview", "5.5", "49534", "31410", "17116", "1008"});
  printRow({"*Banyunibo*", "file", "9.3 m", "close-up", "7.8", "37757", "2401", "33372", "1984"});
  printRow({"*Banyunibo*", "Morton", "0.4 m", "overview", "3.9", "46642", "46572", "68", "2"});
  printRow({"*Banyunibo*", "Morton", "0.4 m", "close-up", "2.1", "20948", "20746", "196", "6"});
  printRow({"*Eclepens*", "file", "190.5 m", "overview", "-", "6711", "5842", "869", "0"});
  printRow({"*Eclepens*", "file", "190.5 m", "close-up", "-", "3689", "1197", "2217", "275"});
  printRow({"*Eclepens*", "Morton", "25.0 m", "overview", "-", "6711", "6708", "3", "0"});
  printRow({"*Eclepens*", "Morton", "25.0 m", "close-up", "-", "2604", "2494", "104", "6"});
}

/// 4.4.2: everything outside the image, nothing culled, with 10, 20 and 30 bits.
void forcedPrecision(const Setup& setup) {
  if (setup.gl.empty()) {
    std::printf("\n4.4.2 needs OpenGL: not measured.\n");
    return;
  }
  const Cloud cloud = buildingCloud("temple", setup.points(529));
  const RenderList list = unstructured(cloud, setup.nodePoints);
  View away = setup.sized(cloud.outside);
  away.target = away.eye + (away.eye - away.target);
  std::printf("\n4.4.2: %s points, all outside the image and none culled, by compute shaders on %s; milliseconds.\n",
              count(static_cast<double>(cloud.count)).c_str(), setup.gl.c_str());
  printHeader({"bits", "ms", "against 10 bits", "*paper (529 M)*", "*against 10 bits*"});
  constexpr double kPaperMs[] = {2.93, 5.23, 7.61};
  double least = 0.0;
  for (const int planes : {1, 2, 3}) {
    ComputeExperiment experiment;
    experiment.forcedPlanes = planes;
    const double ms = measureWay(setup, bestWay(), list, away, experiment)->ms;
    if (planes == 1) least = ms;
    const double paper = kPaperMs[planes - 1];
    printRow({std::to_string(10 * planes), number(ms, 2), number(ms / least, 2), number(paper, 2),
              number(paper / kPaperMs[0], 2)});
  }
}

/// 3.6 and 4.3: two eyes in one pass against two passes.
void twoEyes(const Setup& setup) {
  const Cloud cloud = buildingCloud("temple", setup.points(529));
  const RenderList list = layered(cloud, kLodNodePoints);
  const auto rasterizer =
      createRasterizer(setup.backend(), roomFor(list), setup.ours == "cpu" ? nullptr : createHeadlessContext());
  View left = setup.sized(cloud.outside), right = left;
  right.eye += glm::dvec3(0.04, -0.04, 0.0);
  right.target += glm::dvec3(0.04, -0.04, 0.0);
  const View views[] = {left, right};
  const auto time = [&](const DrawStats& stats) { return drawingMs(*rasterizer, stats); };
  std::vector<double> together, apart;
  Picture frames[2];
  rasterizer->drawViews(list, views, {}, frames);
  for (int i = 0; i < setup.frames; ++i) {
    together.push_back(time(rasterizer->drawViews(list, views, {}, frames)));
    apart.push_back(time(rasterizer->draw(list, left, {}, frames[0])) +
                    time(rasterizer->draw(list, right, {}, frames[1])));
  }
  for (auto* times : {&together, &apart}) std::sort(times->begin(), times->end());
  const double one = together[together.size() / 2], two = apart[apart.size() / 2];
  std::printf("\n4.3: two eyes, milliseconds. The paper's are of one pass of high-quality shading, the depth.\n");
  printHeader({"", "one pass over the points", "two", "two / one"});
  printRow({"Strata", number(one, 2), number(two, 2), number(two / one, 2)});
  printRow({"*paper, RTX 3090*", "1.7", "2.6", "1.53"});
}

}  // namespace

void runSchuetz(const SuiteOptions& options) {
  const Setup setup = setUp(options, 2560, 1140);
  printHead("Schütz, Kerbl, Wimmer 2022", setup);
  tables1And2(setup);
  orderAndPrecision(setup);
  forcedPrecision(setup);
  twoEyes(setup);
}

}  // namespace strata::suite
