#include <CLI/CLI.hpp>

#include "render/create_rasterizer.h"
#include "core/version.h"
#include "viewer/session/command_line.h"
#include "viewer/window/viewer_app.h"

namespace strata {

std::optional<ViewerOptions> parseViewerOptions(int argc, const char* const* argv) {
  ViewerOptions options;
  std::string backend = "auto", size = "1280x800", pictureSize = "4096x2560";
  bool noEdl = false;
  CLI::App app{"Flies through stores.", "strata-view"};
  app.set_version_flag("--version", "strata-view " + version());
  app.add_option("stores", options.stores,
                 "one or more stores, NAME.strata, shown as layers; scans, which are converted first; or a project")
      ->required();
  app.add_option("--backend", backend, backendChoices())
      ->capture_default_str();
  app.add_option("--size", size, "of the window, pixels")->capture_default_str();
  app.add_option("--point-budget", options.streamer.selection.pointBudget, "most points in a frame")
      ->check(CLI::Range(std::uint64_t{1}, SelectionOptions::kMaxPointBudget))
      ->capture_default_str();
  app.add_option("--point-size", options.pointSize, "side of a point, pixels")
      ->check(CLI::Range(1, 16))
      ->capture_default_str();
  addDrawFlags(app, options.draw);
  addProgressiveFlags(app, options.progressive);
  app.add_option("--cache", options.streamer.cacheBytes, "memory for decoded nodes, such as 512M or 2G")
      ->transform(CLI::AsSizeValue(false));
  app.add_flag("--no-edl", noEdl, "without eye-dome lighting");
  app.add_flag("--convert", options.convert, "convert scans that have no store beside them without asking");
  app.add_option("--picture", options.picture, "write the scene without panels in full detail to this PNG and end");
  app.add_option("--picture-size", pictureSize, "of that picture, up to 16384x16384 pixels")->capture_default_str();
  app.add_option("--screenshot", options.screenshot, "write one complete frame to this PNG and end");
  app.add_option("--state", options.state,
                 "say in this file after every frame what the window shows, as JSON, for scripts");
  if (!parseCommandLine(app, argc, argv)) return std::nullopt;
  options.backend = parseBackend(backend);
  checkProgressive(options.progressive, backend, options.draw);
  options.size = parseSize(size);
  options.pictureSize = parseSize(pictureSize);
  options.colour = colourOf(options.draw);
  DrawOptions checked;
  applyDrawFlags(options.draw, checked);
  options.edl = !noEdl;
  return options;
}

}  // namespace strata
