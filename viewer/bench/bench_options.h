#pragma once
#include <cstdint>
#include <limits>
#include <optional>
#include <string>

#include "core/draw_options.h"
#include "lod/streamer.h"
#include "render/create_rasterizer.h"
#include "viewer/session/draw_flags.h"
#include "viewer/session/picture_size.h"
#include "viewer/session/progressive_flags.h"

namespace strata {

/// The command line of strata-bench.
struct BenchOptions {
  enum class Command { run, makePath, compare };

  Command command = Command::run;
  std::string store;
  std::string makePath;  ///< kind of path to print
  std::string path;      ///< camera path to play; empty = none
  std::string output;    ///< folder
  bool stills = false;
  Backend backend = Backend::automatic;
  PictureSize size;
  StreamerOptions streamer;
  std::optional<ColourMode> colour;
  DrawFlags draw;
  ProgressiveFlags progressive;
  int pointSize = 1;
  bool edl = false;
  bool cold = false;
  bool settle = false;
  bool trace = true;
  int repeat = 1;           ///< flights, each from empty caches
  int screenshotEvery = 0;  ///< frames; 0 = none
  std::string video;        ///< file for a film of the flight; empty = none
  bool json = false;

  std::string reportA, reportB;                                ///< compare: folders or report.json files
  std::string comparison;                                      ///< compare: HTML file; empty = none
  double failAbove = std::numeric_limits<double>::infinity();  ///< share
};

/// Nothing when help or the version was asked for and has been printed. Throws UsageError.
std::optional<BenchOptions> parseBenchOptions(int argc, const char* const* argv);

/// "5%" or "5" as 0.05. Throws UsageError.
double parsePercent(const std::string& text);

}  // namespace strata
