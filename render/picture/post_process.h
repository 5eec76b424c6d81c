#pragma once
#include <algorithm>
#include <glm/gtc/type_precision.hpp>
#include <vector>

#include "core/draw_options.h"
#include "core/picture.h"
#include "core/view.h"
#include "render/picture/visibility.h"
#include "render/thread_pool.h"

namespace strata {

/// How many pixels wide a point at some depth is drawn.
class PointSizes {
 public:
  /// All points are `pixels` wide.
  explicit PointSizes(int pixels);
  PointSizes(const DrawOptions& options, const View& view);

  int at(float depth) const {
    const float pixels = pixelsAtUnitDepth_ / (perspective_ ? depth : 1.0f);
    return pixels > static_cast<float>(least_)
               ? static_cast<int>(std::min(pixels + 0.5f, static_cast<float>(DrawOptions::kLargestPoint)))
               : least_;
  }
  /// True when at() gives the same size for every depth.
  bool even() const { return pixelsAtUnitDepth_ <= 0.0f; }
  bool alwaysOne() const { return least_ <= 1 && pixelsAtUnitDepth_ <= 0.0f; }

 private:
  int least_ = 1;
  float pixelsAtUnitDepth_ = 0.0f;
  bool perspective_ = true;
};

/// How large the window of fillHoles() is at a pixel: 1, 3, 5 or 7 pixels.
class FillSizes {
 public:
  /// With DrawOptions::gaze the window is at least 3 near the gaze, and 5 and 7 in the two rings around it (Schütz
  /// 2022, 3.6).
  FillSizes(const DrawOptions& options, const View& view);

  int at(int x, int y) const;
  bool none() const { return least_ <= 1 && !gaze_; }

 private:
  int least_ = 1;
  bool gaze_ = false;
  float atX_ = 0.0f, atY_ = 0.0f;  ///< pixels of the whole picture
  int left_ = 0, top_ = 0;         ///< of the image in it
  float third_ = 1.0f;
};

/// Fills holes by depth-aware dilation. A pixel is filled if it is empty, or if it lies more than kBlendDepth behind
/// the nearest pixel of the window around it. It is replaced by the closest pixel of the window that is not so far
/// behind; among equally close ones by the upper one, then by the left one. All other pixels stay.
void fillHoles(VisibilityBuffer& buffer, const FillSizes& sizes, const ThreadPool& pool);

/// Lets every point cover a square of pixels; each pixel takes the nearest of the points that cover it. A point of size
/// s at column p covers the columns p - (s - 1) / 2 to p + s / 2, and rows likewise. Columns and rows are done one
/// after the other, which is right because a nearer point is never smaller.
void dilate(VisibilityBuffer& buffer, const PointSizes& sizes, const ThreadPool& pool);

/// Lights the picture by eye-dome lighting (Boucheny 2009): a pixel gets darker the farther its eight neighbours lie in
/// front of it. Distances are differences of log2(depth), so the effect does not depend on the scale of the scene. The
/// background stays. Neighbours are as far away as points are wide, so that single points of a slope get no outlines.
/// `scratch` is memory to work in, of any size.
void eyeDomeLighting(Picture& picture, float strength, const PointSizes& sizes, std::vector<float>& scratch,
                     const ThreadPool& pool);

}  // namespace strata
