#include "tests/bench/suites/measure.h"

#include <algorithm>
#include <cstdio>
#include <vector>

#include "core/error.h"
#include "core/readable.h"
#include "render/gl/gl_functions.h"
#include "viewer/session/program_rasterizer.h"

namespace strata::suite {
namespace {

constexpr double kSoftwareScale = 0.02;
constexpr int kSoftwareFrames = 5;
constexpr double kSmallScale = 0.005;  // below it clouds have too few points for nodes of the usual size

bool isSoftware(const std::string& device) {
  return device.find("llvmpipe") != std::string::npos || device.find("softpipe") != std::string::npos;
}

std::string glDevice() {
  try {
    const auto context = createHeadlessContext();
    return glRenderer(loadGlFunctions(*context));
  } catch (const Error&) {
    return {};  // a machine without OpenGL: its columns stay empty
  }
}

}  // namespace

View Setup::sized(View view) const {
  view.width = width;
  view.height = height;
  return view;
}

Setup setUp(const SuiteOptions& options, int width, int height) {
  Setup setup;
  const std::unique_ptr<Rasterizer> ours = createWindowlessRasterizer(options.backend);
  setup.ours = std::string(ours->name());
  setup.device = ours->device();
  setup.gl = glDevice();
  setup.software = setup.ours == "cpu" || isSoftware(setup.device);
  setup.scale = options.scale > 0.0 ? options.scale : setup.software ? kSoftwareScale : 1.0;
  if (setup.software) setup.frames = kSoftwareFrames;
  setup.width = options.width > 0 ? options.width : width;
  setup.height = options.height > 0 ? options.height : height;
  if (setup.scale < kSmallScale) setup.nodePoints = 5 * Batch::kMaxPoints;
  return setup;
}

void printHead(const std::string& title, const Setup& setup) {
  std::printf(
      "### %s\n\nStrata: %s on %s%s%s; %.4g of the paper's numbers of points, %d x %d; "
      "medians of %d frames by %s.\n",
      title.c_str(), setup.ours.c_str(), setup.device.c_str(), setup.gl.empty() ? "; no OpenGL" : "; OpenGL on ",
      setup.gl.c_str(), setup.scale, setup.width, setup.height, setup.frames,
      setup.software ? "the wall clock" : "OpenGL's clock");
}

RasterizerOptions roomFor(const RenderList& list) {
  RasterizerOptions options;
  options.gpuBytes = list.pointCount * 17 + list.items.size() * 4096 + (std::uint64_t{256} << 20);
  options.uploadBytesPerFrame = std::uint64_t{4} << 30;
  return options;
}

double drawingMs(const Rasterizer& rasterizer, const DrawStats& stats) {
  return stats.gpuMs > 0.0 && !isSoftware(rasterizer.device()) ? stats.gpuMs : stats.drawMs;
}

Measure measure(Rasterizer& rasterizer, const RenderList& list, const View& view, const DrawOptions& draw, int frames) {
  Picture frame;
  Measure result;
  do {
    result.stats = rasterizer.draw(list, view, draw, frame);
  } while (result.stats.nodesNotUploaded > 0 && result.stats.bytesUploaded > 0);
  if (result.stats.nodesNotUploaded > 0) throw Error(rasterizer.device(), "the cloud does not fit into its memory");
  std::vector<double> times;
  for (int i = 0; i < frames; ++i) {
    const DrawStats stats = rasterizer.draw(list, view, draw, frame);
    times.push_back(drawingMs(rasterizer, stats));
  }
  std::nth_element(times.begin(), times.begin() + frames / 2, times.end());
  result.ms = times[static_cast<std::size_t>(frames / 2)];
  return result;
}

Measure measureOurs(const Setup& setup, const RenderList& list, const View& view, const DrawOptions& draw) {
  const auto rasterizer =
      createRasterizer(setup.backend(), roomFor(list), setup.ours == "cpu" ? nullptr : createHeadlessContext());
  return measure(*rasterizer, list, view, draw, setup.frames);
}

std::optional<double> pointsMs(const Setup& setup, const RenderList& list, const View& view) {
  if (setup.gl.empty()) return std::nullopt;
  const auto rasterizer = createRasterizer(Backend::points, roomFor(list), createHeadlessContext());
  return measure(*rasterizer, list, view, {}, std::max(setup.frames / 5, 3)).ms;
}

std::optional<Measure> measureWay(const Setup& setup, ComputeWay way, const RenderList& list, const View& view,
                                  const ComputeExperiment& experiment) {
  if (setup.gl.empty() || (way == ComputeWay::compute64 && bestWay() != way)) return std::nullopt;
  const auto rasterizer = createComputeRasterizer(way, createHeadlessContext(), roomFor(list), experiment);
  return measure(*rasterizer, list, view, {}, std::max(setup.frames / 3, 3));
}

ComputeWay bestWay() {
  return hasWideAtomics(*createHeadlessContext()) ? ComputeWay::compute64 : ComputeWay::compute32;
}

void printRow(std::span<const std::string> cells) {
  for (const std::string& cell : cells) std::printf("| %s ", cell.c_str());
  std::printf("|\n");
  std::fflush(stdout);
}

void printRow(std::initializer_list<std::string> cells) { printRow(std::span(cells.begin(), cells.size())); }

void printHeader(std::initializer_list<std::string> cells) {
  std::printf("\n");
  printRow(cells);
  for (std::size_t i = 0; i < cells.size(); ++i) std::printf("|---");
  std::printf("|\n");
}

std::string number(double value, int decimals) {
  char text[48];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  return text;
}

std::string number(const std::optional<double>& value, int decimals) { return value ? number(*value, decimals) : "-"; }

std::string count(double value) { return readableCount(value); }

}  // namespace strata::suite
