#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/draw_options.h"
#include "core/picture.h"
#include "core/view.h"
#include "lod/streamer.h"
#include "render/create_rasterizer.h"
#include "render/gl/gl_context.h"
#include "render/progressive/progressive_rasterizer.h"
#include "viewer/camera/camera_control.h"
#include "viewer/session/layers.h"
#include "viewer/window/frame_history.h"
#include "viewer/window/picture_texture.h"
#include "viewer/window/viewer_options.h"

namespace strata {

/// What the newest frame took and what its picture still lacks.
struct FrameReport {
  DrawStats draw;
  StreamerStats streamer;
  FrameHistory history;
  double frameMs = 0.0;  ///< smoothed over some frames
  std::size_t nodesDrawn = 0;
  std::uint32_t missingNodes = 0;
  bool complete = false;          ///< every wanted node is in memory
  std::uint64_t framesDrawn = 0;  ///< since the start
};

/// Streams the layers, draws them with a rasterizer and holds the newest picture, also as a texture. For the render
/// thread, with the window's context current.
class LayerRenderer {
 public:
  /// Begins to stream. Throws Error where the rasterizer that `options` name cannot work here.
  LayerRenderer(std::vector<std::shared_ptr<const Store>> stores, const ViewerOptions& options,
                GlContext::GetProc getProc);

  /// Draws the picture that `view` sees. The nodes are selected for `chosenFor`, which is an earlier view while the
  /// user has frozen the selection.
  void draw(const View& view, const View& chosenFor, const DrawOptions& options);
  /// Draws with another backend from now on. Throws Error where it cannot work here; the present one then stays.
  void switchTo(Backend backend);

  Layers& layers() { return layers_; }
  Rasterizer& rasterizer() { return *rasterizer_; }
  /// The same rasterizer; null where it draws all points in each frame.
  ProgressiveRasterizer* progressive() { return progressive_; }
  Backend backend() const { return backend_; }  ///< as it was asked for
  const std::string& rasterizerName() const { return rasterizerName_; }

  // The newest picture.
  const Picture& picture() const { return picture_; }
  const PictureTexture& texture() const { return texture_; }
  /// The list it was drawn from, valid until the next draw(); null before the first.
  const RenderList* list() const { return list_; }
  const FrameReport& report() const { return report_; }

 private:
  void use(std::unique_ptr<Rasterizer> rasterizer);

  const GlContext::GetProc getProc_;
  Layers layers_;
  PictureTexture texture_;
  std::unique_ptr<Rasterizer> rasterizer_;
  ProgressiveRasterizer* progressive_ = nullptr;
  Backend backend_;
  std::string rasterizerName_;
  CameraMotion motion_;
  const RenderList* list_ = nullptr;
  Picture picture_;
  FrameReport report_;
};

}  // namespace strata
