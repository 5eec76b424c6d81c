#pragma once
#include <chrono>
#include <string>

#include "core/draw_options.h"
#include "core/picture.h"
#include "lod/selection.h"
#include "render/rasterizer.h"
#include "viewer/camera/camera_path.h"
#include "viewer/output/video.h"
#include "viewer/session/layers.h"

namespace strata {

/// A film of a camera path, every frame in full detail.
struct FilmOrder {
  std::string file;  ///< its ending chooses the container, as in flight.mp4
  CameraPath path;
  int width = 1920, height = 1080;
  DrawOptions draw;
};

/// Draws a film frame by frame and hands it to ffmpeg. For the render thread, as PictureTaker is.
class FilmTaker {
 public:
  /// Throws Error when ffmpeg is not installed.
  FilmTaker(FilmOrder order, Layers& layers, Rasterizer& rasterizer);
  /// Leaves no file behind, unless the film is complete.
  ~FilmTaker();

  /// Waits at most `patience` for full detail, and draws a frame when it is there. Returns true when the film is
  /// written. Throws Error when it cannot be written.
  bool goOn(std::chrono::milliseconds patience);
  double progress() const { return static_cast<double>(index_) / frames_; }
  const Picture& frame() const { return frame_; }

 private:
  const FilmOrder order_;
  const PathClock clock_;
  const int frames_;
  Layers& layers_;
  Rasterizer& rasterizer_;
  const std::string unfinished_;  ///< the file until the film is complete, so that an older film stays until then
  VideoWriter video_;
  Picture frame_;
  int index_ = 0;
  bool asked_ = false;
  bool finished_ = false;
  std::chrono::steady_clock::time_point giveUpAt_;
};

}  // namespace strata
