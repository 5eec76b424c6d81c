#pragma once
#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "core/draw_options.h"
#include "core/image.h"
#include "core/picture.h"
#include "core/view.h"
#include "render/rasterizer.h"
#include "viewer/session/layers.h"

namespace strata {

/// A picture to be written as a PNG. The view has the picture's size.
struct PictureOrder {
  static constexpr int kLargestSide = 16384;

  std::string file;
  View view;
  DrawOptions draw;
  SelectionOptions
      selection;  ///< its points per pixel count; its budget does not, a part gets all points that it wants
};

/// Scales the sizes of points so that they look as wide in a picture of `toHeight` rows as on a screen of `fromHeight`.
DrawOptions scaledToPicture(const DrawOptions& draw, int fromHeight, int toHeight);

/// Draws a picture of any size part by part, each in full detail, and writes it from the top down. It keeps a row of
/// parts, one part and the layers' caches in memory; a part whose nodes do not fit the caches is drawn in quarters. It
/// is for the render thread, which must not use the layers for anything else meanwhile, and must set their selection
/// again afterwards.
class PictureTaker {
 public:
  /// Throws Error when the file cannot be made, and for an overdraw picture of more than one part.
  PictureTaker(PictureOrder order, Layers& layers, Rasterizer& rasterizer);

  /// Waits at most `patience` for full detail, and draws a part when it is there. Returns true when the picture is
  /// written. Throws Error when it cannot be written. A taker that is not asked to go on leaves no file behind.
  bool goOn(std::chrono::milliseconds patience);
  double progress() const;  ///< share of the pixels drawn
  /// Parts drawn without all their detail: it did not come in time, or did not fit the caches however small the part.
  int unfinishedParts() const { return unfinished_; }
  /// The newest part, which can be shown while the user waits.
  const Picture& frame() const { return frame_; }

 private:
  struct Part {
    int left, top, width, height;
  };

  void nextRow();
  void split(const Part& part);

  const PictureOrder order_;
  const int margin_;
  Layers& layers_;
  Rasterizer& rasterizer_;
  PngWriter png_;
  Image row_;  ///< of parts; its first row is rowTop_
  int rowTop_ = 0;
  std::vector<Part> open_;  ///< the parts of the row that are still to be drawn, the next one last
  Picture frame_;
  bool asked_ = false;  ///< the layers are loading the next part
  std::uint64_t overCapacityBefore_ = 0;
  std::chrono::steady_clock::time_point giveUpAt_;
  std::uint64_t drawnPixels_ = 0;
  int unfinished_ = 0;
};

}  // namespace strata
