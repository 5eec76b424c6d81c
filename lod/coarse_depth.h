#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/view.h"
#include "lod/contour.h"
#include "lod/occluders.h"

namespace strata {

/// When a surface counts as closed, by Occluder::gap on the screen. By default as the scan shows it: a surface without
/// a hole hides what is behind it even from so near that the pixels between its points show it.
struct OcclusionOptions {
  bool enabled = true;
  double gapPixels = 256.0;            ///< of a surface that is loaded to its last point
  double openGapPixels = 64.0;         ///< of one of which finer points are still to come: they may show a hole in it
  std::uint32_t mostOccluders = 4000;  ///< rasterized for one view, largest first

  /// Surfaces hide only what they leave no pixel of.
  static OcclusionOptions exact() { return {.gapPixels = 1.0, .openGapPixels = 1.0}; }

  bool operator==(const OcclusionOptions&) const = default;
};

/// Kanzok's coarse depth buffer (2015, 3.2.1, item 4): for each of 128 x 128 cells of the image the depth behind which
/// nothing can be seen. Filled from occluders by a coverage rasterizer (Pineda 1988: a sample is covered where it is
/// inside of all edges; here the edges are solved for x, eight rows at once) at 4 x 4 samples a cell; a cell is closed
/// where all its samples, and those around them, are. Depth is that of the far side of the occluder's layer.
///
/// One thread fills it; then any number may test.
class CoarseDepth {
 public:
  static constexpr int kSide = 128;        ///< cells along either side of the image
  static constexpr int kSamplesACell = 4;  ///< along either axis
  static constexpr int kSamples = kSide * kSamplesACell;

  CoarseDepth();

  /// Everything is open.
  void clear(const View& view, const OcclusionOptions& options);
  /// Rasterizes what of the set is closed at its distance. Sets on which nothing of use is are told apart quickly.
  void add(const OccluderSet& set);
  /// After the last add(): from samples to cells.
  void finish();

  const View& view() const { return view_; }
  std::uint32_t drawn() const { return drawn_; }  ///< occluders since clear()

  /// True when the contour, grown by `reach` metres on all sides, lies behind closed cells wherever it is in the image.
  bool hides(const Contour& contour, double reach) const;

  /// The depth of a cell in metres, infinite where it is open. For tests and pictures.
  double depth(int column, int row) const;

 private:
  /// Linear over the image and larger for what is nearer: 1 / depth in perspective, -depth in an orthographic view.
  using Nearness = float;

  /// A function that is linear over the image.
  struct Linear {
    float a = 0.0f, b = 0.0f, c = 0.0f;
    float at(float x, float y) const { return a + b * x + c * y; }
  };
  /// A convex polygon on the sample grid.
  struct Polygon {
    std::array<glm::vec2, Occluder::kMaxCorners + 1> corner;
    std::size_t corners = 0;
    Linear nearness;
  };
  /// The faces of a box over the cells. A ray enters the box at the least nearness of the faces towards the eye and
  /// leaves it at the largest of the others; it misses the box where that is nothing.
  struct BoxFaces {
    std::array<Linear, 6> entry, exit;
    std::size_t entries = 0, exits = 0;
  };
  struct CellRect {
    int left, right, top, bottom;  ///< all of them inside
  };

  bool project(const Occluder& occluder, const glm::dvec3& originFromEye, Polygon& out) const;
  /// Of the plane dot(normal, p - eye) = along; x and y count steps of so many pixels. False where it is seen edge-on.
  bool linearNearness(const glm::dvec3& normal, double along, double stepX, double stepY, Linear& out) const;
  BoxFaces facesOf(const Contour& contour, double reach) const;
  bool isBehind(const CellRect& rect, const BoxFaces& faces, Nearness nearest) const;
  void fill(const Polygon& polygon);
  Nearness nearnessOf(double depth) const;

  View view_;
  OcclusionOptions options_;
  ViewBasis basis_;
  Projection projection_;
  double pixelsPerMetre_ = 0.0;  ///< at 1 m in perspective, everywhere in an orthographic view
  Nearness open_ = 0.0f;         ///< of samples without an occluder: below all others
  std::uint32_t drawn_ = 0;
  int firstRow_ = kSamples, lastRow_ = -1;  ///< of samples that were filled
  std::vector<Nearness> samples_;           ///< kSamples x kSamples, rows from the top
  std::vector<Nearness> narrowed_;          ///< scratch of finish(): least of each cell's columns, kSamples rows
  std::vector<Nearness> cells_;             ///< kSide x kSide
};

}  // namespace strata
