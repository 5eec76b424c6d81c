// Günther, Kanzok, Linsen, Rosenthal 2013: Figure 3 (the plane stack), Figure 4 and the views of Table 1.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

#include "tests/bench/suites/clouds.h"
#include "tests/bench/suites/measure.h"
#include "tests/bench/suites/suites.h"

namespace strata::suite {
namespace {

constexpr int kSide = 1024;   ///< of the paper's planes and of its picture
constexpr int kPlanes = 170;  ///< that filled the memory of its GPU
constexpr double kStep = 0.001;

/// `count` planes of side x side points, one behind the other, shuffled (5.1).
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
      points.push_back((glm::dvec3(cells[i]) + glm::dvec3(0.5, 0.5, 1.0)) * kStep);
    nodes.push_back(colouredNode(points, 0.5 * kStep));
  }
  return listOf(nodes);
}

/// An orthographic view of the stack in which a plane's side is `pixels`.
View stackView(int side, int pixels) {
  View view;
  view.width = view.height = side;
  view.orthographic = true;
  view.orthographicHeight = kStep * side * side / pixels;
  view.eye = glm::dvec3(0.5 * kStep * side, 0.5 * kStep * side, -1.0);
  view.target = view.eye + glm::dvec3(0.0, 0.0, 1.0);
  view.up = glm::dvec3(0.0, -1.0, 0.0);
  return view;
}

std::optional<double> msOf(const std::optional<Measure>& measure) {
  return measure ? std::optional(measure->ms) : std::nullopt;
}

void figure3(const Setup& setup) {
  // The number of planes, on which the paper's question hangs, is kept as long as the side can shrink.
  const int side = std::clamp(static_cast<int>(kSide * std::sqrt(setup.scale)) / 16 * 16, 32, kSide);
  const int most =
      std::clamp(static_cast<int>(setup.points(178.0) / static_cast<std::uint64_t>(side * side)), 4, kPlanes);
  std::printf("\nFigure 3: shuffled planes of %d x %d points, one behind the other; milliseconds.\n", side, side);
  printHeader({"planes", "pixels covered", "GL_POINTS", "compute_lock", "compute32", "compute64", setup.ours,
               "GL_POINTS / compute_lock", "*paper*"});
  const auto row = [&](const RenderList& list, int planes, int pixels, const std::string& paper) {
    const View view = stackView(side, pixels);
    const std::optional<double> gl = pointsMs(setup, list, view);
    const std::optional<double> lock = msOf(measureWay(setup, ComputeWay::computeLock, list, view));
    printRow({std::to_string(planes), std::to_string(pixels * pixels), number(gl, 2), number(lock, 2),
              number(msOf(measureWay(setup, ComputeWay::compute32, list, view)), 2),
              number(msOf(measureWay(setup, ComputeWay::compute64, list, view)), 2),
              number(measureOurs(setup, list, view).ms, 2), gl && lock ? number(*gl / *lock, 2) : "-", paper});
  };
  for (int planes = 1; planes < most; planes *= 2)
    row(planeStack(side, planes, setup.nodePoints), planes, side, planes == 1 ? "0.50 (2.24 / 4.47 ms)" : "");
  const RenderList list = planeStack(side, most, setup.nodePoints);
  for (int pixels = side; pixels >= 1; pixels /= 4) row(list, most, pixels, pixels == side ? "1.21 (170 planes)" : "");
  std::printf(
      "\nThe paper (Radeon HD 7970, OpenCL against OpenGL, planes of 1024 x 1024): equal at 46 planes, 1.21 at 170.\n");
}

/// Many depth tests with some culling (1, 2), much culling (3), an overview (4).
void table1(const Setup& setup) {
  const Cloud cloud = buildingCloud("building", setup.points(138));
  const RenderList list = unstructured(cloud, setup.nodePoints);
  View inner = cloud.inside, corner = cloud.inside, overview = cloud.outside;
  corner.eye = {5.5, 5.5, 1.7};
  corner.target = {4.5, 4.2, 1.5};
  overview.eye *= 4.0;
  inner.target = {13.0, 40.0, 1.7};
  const std::pair<int, View> views[] = {{1, cloud.inside}, {2, inner}, {3, corner}, {4, overview}};
  std::printf("\nTable 1 and Figure 4: frames a second, %s points.\n", count(static_cast<double>(cloud.count)).c_str());
  printHeader(
      {"view", "points after culling", "GL_POINTS", "compute_lock", setup.ours, "GL_POINTS / compute_lock (time)"});
  for (const auto& [number_, view] : views) {
    const View sized = setup.sized(view);
    const Measure ours = measureOurs(setup, list, sized);
    const std::optional<double> gl = pointsMs(setup, list, sized);
    const std::optional<double> lock = msOf(measureWay(setup, ComputeWay::computeLock, list, sized));
    printRow({std::to_string(number_), count(static_cast<double>(ours.stats.pointsDrawn)),
              gl ? number(1e3 / *gl, 1) : "-", lock ? number(1e3 / *lock, 1) : "-", number(1e3 / ours.ms, 1),
              gl && lock ? number(*gl / *lock, 2) : "-"});
  }
  printRow({"*Figure 4, 138 M points, HD 7970*", "-", "5 (129 ms)", "56 (18 ms)", "-", "7.2"});
}

}  // namespace

void runGuenther(const SuiteOptions& options) {
  const Setup setup = setUp(options, kSide, kSide);
  printHead("Günther, Kanzok, Linsen, Rosenthal 2013", setup);
  figure3(setup);
  table1(setup);
}

}  // namespace strata::suite
