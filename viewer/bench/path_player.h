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
#include "viewer/session/picture_size.h"

namespace strata {

struct PlayOptions {
  PictureSize size;
  DrawOptions draw;
  bool settle = false;
  int screenshotEvery = 0;
  std::string folder;  ///< for the pictures
  std::string video;   ///< film of every frame; empty = none
  double nearPlane = 0.01;
  bool pictures = true;          ///< false: no pictures at all, not even of marked frames
  const Store* store = nullptr;  ///< the streamer's store, to measure the widest spacing; null = not measured
  TraceLane* lane = nullptr;     ///< records the spans of this thread; null = none
};

/// The results of a flight.
struct PlayedPath {
  std::vector<FrameRecord> frames;
  double timeToFullDetailMs = 0.0;
  bool reachedFullDetail = false;
  std::vector<JumpRecord> jumps;        ///< the start, then each cut of the path
  std::vector<ReportPicture> pictures;  ///< those that the report does not show have no pixels
};

/// Flies the whole path on the calling thread, which becomes the streamer's render thread. Takes pictures of every
/// screenshotEvery-th frame and of the marked frames of the path.
PlayedPath playPath(const CameraPath& path, const PlayOptions& options, Streamer& streamer, Rasterizer& rasterizer);

/// Draws one picture in full detail: waits for the streamer, then draws until all nodes of the list are on the GPU.
Picture drawComplete(const View& view, const DrawOptions& draw, Streamer& streamer, Rasterizer& rasterizer);

}  // namespace strata
