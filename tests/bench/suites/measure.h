#pragma once
#include <optional>
#include <span>
#include <string>

#include "render/create_rasterizer.h"
#include "render/gpu/compute_rasterizer.h"
#include "tests/bench/suites/suites.h"

namespace strata::suite {

/// How this machine draws the suites.
struct Setup {
  std::string ours;      ///< Rasterizer::name()
  std::string device;    ///< Rasterizer::device()
  std::string gl;        ///< OpenGL's renderer; empty: there is no OpenGL, so no GL_POINTS
  bool software = true;  ///< no GPU draws
  double scale = 1.0;
  int frames = 30;  ///< of a median
  int width = 0, height = 0;
  std::uint32_t nodePoints = 50 * Batch::kMaxPoints;  ///< of unstructured clouds

  std::uint64_t points(double millions) const { return static_cast<std::uint64_t>(millions * 1e6 * scale); }
  View sized(View view) const;
  Backend backend() const { return parseBackend(ours); }
};
/// `width` and `height` are the paper's, where the options do not name others.
Setup setUp(const SuiteOptions& options, int width, int height);

/// "# Title" with what draws.
void printHead(const std::string& title, const Setup& setup);

/// Memory for all of a list on the GPU.
RasterizerOptions roomFor(const RenderList& list);

/// Clearing, culling and drawing, without resolving to colours: on a GPU by OpenGL's own clock, else by the wall clock
/// (llvmpipe's clock does not wait for what it has put off), which for OpenGL holds reading the picture back.
double drawingMs(const Rasterizer& rasterizer, const DrawStats& stats);
/// Its median over frames, when all is uploaded.
struct Measure {
  double ms = 0.0;
  DrawStats stats;
};
Measure measure(Rasterizer& rasterizer, const RenderList& list, const View& view, const DrawOptions& draw, int frames);
/// With our rasterizer.
Measure measureOurs(const Setup& setup, const RenderList& list, const View& view, const DrawOptions& draw = {});
/// With GL_POINTS; nothing where there is no OpenGL.
std::optional<double> pointsMs(const Setup& setup, const RenderList& list, const View& view);
/// With compute shaders of one way; nothing where OpenGL lacks what it needs.
std::optional<Measure> measureWay(const Setup& setup, ComputeWay way, const RenderList& list, const View& view,
                                  const ComputeExperiment& experiment = {});
/// The fastest way that OpenGL here has.
ComputeWay bestWay();

/// "| a | b |" and a line end, at once on stdout.
void printRow(std::span<const std::string> cells);
void printRow(std::initializer_list<std::string> cells);
void printHeader(std::initializer_list<std::string> cells);
/// "1.23", or "-" for nothing.
std::string number(double value, int decimals);
std::string number(const std::optional<double>& value, int decimals);
/// "12.3 M", "4.0 k", "317".
std::string count(double value);

}  // namespace strata::suite
