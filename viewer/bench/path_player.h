#pragma once
#include <string>
#include <vector>

#include "core/draw_options.h"
#include "core/picture.h"
#include "lod/streamer.h"
#include "lod/trace.h"
#include "render/rasterizer.h"
#include "viewer/bench/report.h"
#include "viewer/camera/camera_path.h"
#include "viewer/session/drawing.h"

namespace strata {

struct PlayOptions {
  PictureSize size;
  DrawOptions draw;
  bool settle = false;
  int screenshotEvery = 0;
  std::string folder;  ///< for the pictures
  std::string video;   ///< film of every frame; empty = none
  double nearPlane = 0.01;
  bool pictures = true;          ///< false: none at all, marked frames neither
  const Store* store = nullptr;  ///< of the streamer, for the widest spacing on the screen; null = not measured
  TraceLane* lane = nullptr;     ///< gets what this thread does
};

/// What a flight left behind.
struct PlayedPath {
  std::vector<FrameRecord> frames;
  double timeToFullDetailMs = 0.0;
  bool reachedFullDetail = false;
  std::vector<JumpRecord> jumps;        ///< the start, then each cut of the path
  std::vector<ReportPicture> pictures;  ///< the ones that the report does not show have no pixels
};

/// The whole flight, on the calling thread, which becomes the streamer's render thread. Pictures are taken of every
/// screenshotEvery-th frame and of the path's marked ones.
PlayedPath playPath(const CameraPath& path, const PlayOptions& options, Streamer& streamer, Rasterizer& rasterizer);

/// Draws until everything in the list is on the GPU: one picture in full detail. Waits for the streamer first.
Picture drawComplete(const View& view, const DrawOptions& draw, Streamer& streamer, Rasterizer& rasterizer);

}  // namespace strata
