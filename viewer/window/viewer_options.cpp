#include "viewer/window/viewer_options.h"

#include <CLI/CLI.hpp>

#include "core/program/command_line.h"
#include "core/version.h"
#include "viewer/session/picture_size.h"

namespace strata {

std::optional<ViewerOptions> parseViewerOptions(int argc, const char* const* argv) {
  ViewerOptions options;
  std::string backend = "auto", size = "1280x800", pictureSize = "4096x2560";
  bool noEdl = false;
  CLI::App app{"Shows converted scans and flies through them.", "strata-view"};
  app.set_version_flag("--version", "strata-view " + version());
  app.add_option("stores", options.stores,
                 "stores (NAME.strata), shown as layers; scans, which are converted first; or one project (.json)")
      ->required();
  app.add_option("--backend", backend, backendChoices())->capture_default_str();
  app.add_option("--size", size, "size of the window in pixels")->capture_default_str();
  app.add_option("--point-budget", options.streamer.selection.pointBudget, "largest number of points in a frame")
      ->check(CLI::Range(std::uint64_t{1}, SelectionOptions::kMaxPointBudget))
      ->capture_default_str();
  app.add_option("--point-size", options.pointSize, "side of a point in pixels")
      ->check(CLI::Range(1, 16))
      ->capture_default_str();
  addDrawFlags(app, options.draw);
  addProgressiveFlags(app, options.progressive);
  app.add_option("--cache", options.streamer.cacheBytes, "memory for decoded nodes, such as 512M or 2G")
      ->transform(CLI::AsSizeValue(false));
  app.add_flag("--no-edl", noEdl, "switch eye-dome lighting off");
  app.add_flag("--convert", options.convert, "convert scans that have no store yet, without asking");
  app.add_option("--picture", options.picture,
                 "draw the scan without panels in full detail, write it to this PNG file and exit");
  app.add_option("--picture-size", pictureSize, "size of that picture, up to 16384x16384 pixels")
      ->capture_default_str();
  app.add_option("--screenshot", options.screenshot,
                 "draw one frame in full detail, write the window to this PNG file and exit");
  app.add_option("--state", options.state,
                 "write what the window shows to this JSON file after every frame, for scripts");
  if (!parseCommandLine(app, argc, argv)) return std::nullopt;
  options.backend = parseBackend(backend);
  checkProgressive(options.progressive, backend, options.draw);
  options.size = parseSize(size);
  options.pictureSize = parseSize(pictureSize);
  options.colour = colourOf(options.draw);
  DrawOptions checked;  // wrong flags are refused now, before a window is opened
  applyDrawFlags(options.draw, checked);
  options.edl = !noEdl;
  return options;
}

}  // namespace strata
