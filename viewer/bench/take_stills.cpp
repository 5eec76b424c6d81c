#include "viewer/bench/take_stills.h"

#include <algorithm>

#include "core/picture.h"
#include "viewer/bench/path_player.h"
#include "viewer/camera/stills.h"
#include "viewer/session/draw_defaults.h"

namespace strata {
namespace {

constexpr double kStillPointsPerPixel = 4.0;  // leaves no pinholes
constexpr double kWidestSpacingPx = 6.5;      // between points in a still; beyond, the camera steps back ...
constexpr double kWantedSpacingPx = 5.0;      // ... for this
constexpr int kStepsBack = 3;

/// Draws a still in full detail. If the scan is too sparse for a camera so near, the camera steps back, at most to
/// `farthest` metres.
Image takeStill(Still still, double farthest, DrawOptions draw, Streamer& streamer, Rasterizer& rasterizer) {
  DrawOptions bare = draw;
  bare.pointSize = 1;
  bare.fill = 1;
  bare.jumpFlood = bare.edl = false;
  FrontSpacing spacing;
  for (int step = 0; step < kStepsBack; ++step) {
    spacing = frontSpacing(drawComplete(still.view, bare, streamer, rasterizer), still.view);
    const double factor = std::min(spacing.pixels / kWantedSpacingPx, farthest / still.subject);
    if (spacing.pixels <= kWidestSpacingPx || factor <= 1.05) break;
    still = fartherStill(still, factor);
  }
  draw.pointSize = draw.jumpFlood ? 1 : closedPointSize(spacing.pixels);
  draw.pointMetres = draw.jumpFlood ? 0.0f : closedPointMetres(spacing.metres);
  draw.edl = true;
  return imageOf(drawComplete(still.view, draw, streamer, rasterizer));
}

}  // namespace

void takeStills(const BenchOptions& options, const std::shared_ptr<const Store>& store, Rasterizer& rasterizer,
                BenchReport& report) {
  const ScanSample scan = sampleStore(*store);
  StreamerOptions rich = options.streamer;
  rich.selection.pointsPerPixel = std::max(rich.selection.pointsPerPixel, kStillPointsPerPixel);
  DrawOptions draw = drawOptionsFor(store->info(), scan.bounds, options.colour);
  applyDrawFlags(options.draw, draw);
  // A map of heights is read by its relief, which splats smooth away.
  if (options.draw.fill.empty()) draw.jumpFlood = draw.colour != ColourMode::elevation;
  rich.selection.shown = shownBy(draw);
  Streamer streamer(store, rich);
  std::vector<ReportPicture> pictures;
  double farthest = 0.0;  // the overview stays where it is, each one after it nearer than the one before
  for (const Still& still : chooseStills(scan, *store, options.size.width, options.size.height)) {
    pictures.push_back(
        {still.name, still.name + ".png", false, takeStill(still, farthest, draw, streamer, rasterizer)});
    writePng(options.output + "/" + pictures.back().file, pictures.back().image);
    pictures.back().hash = imageHash(pictures.back().image);
    farthest = scan.enclosed ? 0.0 : 0.7 * still.subject;
  }
  report.pictures.insert(report.pictures.begin(), pictures.begin(), pictures.end());
}

}  // namespace strata
