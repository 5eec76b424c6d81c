#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/view.h"
#include "lod/contour.h"
#include "lod/occluders.h"

namespace strata {

/// When a surface counts as closed: while Occluder::gap covers at most this many pixels. The defaults trust the scan: a
/// surface without a hole hides everything behind it, even from so near that the picture shows gaps between its points.
struct OcclusionOptions {
  bool enabled = true;
  double gapPixels = 256.0;            ///< for a surface that is loaded to its last point
  double openGapPixels = 64.0;         ///< for one with finer points still to come, which may show a hole in it
  std::uint32_t mostOccluders = 4000;  ///< rasterized for one view, the largest first

  /// Returns options with which a surface hides an object only if it covers every pixel of that object.
  static OcclusionOptions exact() { return {.gapPixels = 1.0, .openGapPixels = 1.0}; }

  bool operator==(const OcclusionOptions&) const = default;
};

/// Kanzok's coarse depth buffer (2015, 3.2.1, item 4): for each of 128 x 128 cells of the picture the depth behind
/// which nothing can be seen. Occluders are rasterized at 4 x 4 samples per cell (Pineda 1988: a sample is covered when
/// it is inside all edges; here the edges are solved for x, for eight rows at once), with the depth of the far side of
/// their layer. A cell is closed when all its samples and those around them are covered.
///
/// One thread fills it; after that, any number of threads may test.
class CoarseDepth {
 public:
  static constexpr int kSide = 128;        ///< cells along either side of the picture
  static constexpr int kSamplesACell = 4;  ///< along either axis
  static constexpr int kSamples = kSide * kSamplesACell;

  CoarseDepth();

  /// Begins a new view, with every cell open.
  void clear(const View& view, const OcclusionOptions& options);
  /// Rasterizes the occluders that are closed at their distance. Skips sets too small or too far away to matter.
  void add(const OccluderSet& set);
  /// After the last add(): makes the cells out of the samples.
  void finish();

  const View& view() const { return view_; }
  std::uint32_t drawn() const { return drawn_; }  ///< occluders rasterized since clear()

  /// True when the contour, grown by `reach` metres on all sides, lies behind closed cells wherever it is in the
  /// picture.
  bool hides(const Contour& contour, double reach) const;

  /// The depth of a cell in metres, infinite when it is open; for tests and pictures.
  double depth(int column, int row) const;

 private:
  /// Larger for nearer things, and linear over the picture: 1 / depth in perspective, -depth in an orthographic view.
  using Nearness = float;

  /// A function that is linear over the picture.
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
  /// leaves it at the largest nearness of the others; it misses the box when it would leave before it enters.
  struct BoxFaces {
    std::array<Linear, 6> entry, exit;
    std::size_t entries = 0, exits = 0;
  };
  struct CellRect {
    int left, right, top, bottom;  ///< all four belong to the rectangle
  };

  bool project(const Occluder& occluder, const glm::dvec3& originFromEye, Polygon& out) const;
  /// The nearness of the plane dot(normal, p - eye) = along, where x and y count steps of so many pixels. False when
  /// the plane is seen edge-on.
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
  Nearness open_ = 0.0f;         ///< nearness of samples without an occluder, below all others
  std::uint32_t drawn_ = 0;
  int firstRow_ = kSamples, lastRow_ = -1;  ///< rows of samples that were filled
  std::vector<Nearness> samples_;           ///< kSamples x kSamples, rows from the top
  std::vector<Nearness> narrowed_;          ///< memory of finish(): the least of each cell's columns, kSamples rows
  std::vector<Nearness> cells_;             ///< kSide x kSide
};

}  // namespace strata
