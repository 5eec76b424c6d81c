#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/draw_options.h"
#include "core/node_data.h"
#include "core/view.h"
#include "io/store/store.h"
#include "lod/clip_region.h"
#include "lod/coarse_depth.h"
#include "lod/contour.h"

namespace strata {

struct SelectionOptions {
  double pointsPerPixel = 1.8;  ///< wanted density on the screen, for one layer of surface; docs/lod.md says why
  std::uint64_t pointBudget = 10'000'000;  ///< never more points than this; kMaxPointBudget at most
  double minimumPixels = 1.0;              ///< nodes whose longest side is shorter than this are left to their parents

  static constexpr std::uint64_t kMaxPointBudget = 0xfffffffeu;  ///< point ids of a frame have 32 bits

  OcclusionOptions occlusion{};  ///< how the streamer fills the coarse depth
  /// What the streamer reads of a node beside its positions: what this shows. Nothing: colour, intensity and class.
  std::optional<ColourMode> shown{};
  bool normals = false;  ///< ... and the normals, where the store has them
  /// The streamer draws a node that has been in view all along in full no sooner than so long after its first point.
  double fadeSeconds = 0.2;
  Clip clip{};  ///< nodes of which nothing is left by it are not drawn, read or counted; it does not cut the others

  bool operator==(const SelectionOptions&) const = default;
};

struct SelectedNode {
  std::uint32_t node = 0;                   ///< index in the Hierarchy
  std::uint32_t pointCount = 0;             ///< prefix of the node's level order
  float priority = 0.0f;                    ///< how many times too few points its parents alone would put there; >= 1
  Precision precision = Precision::full30;  ///< that drawing needs: half a pixel (Schütz 2022, 3.3)
};

/// The result, and the memory of the walk, so that a Selection used again allocates nothing.
struct Selection {
  std::vector<SelectedNode> nodes;    ///< most urgent first; parents before their children
  std::uint64_t pointCount = 0;       ///< sum over nodes
  std::uint32_t tested = 0;           ///< contours looked at
  std::uint32_t occluded = 0;         ///< of these, left out because something hides them
  std::vector<std::uint32_t> hidden;  ///< those, in no order
  bool budgetReached = false;
  double pointsPerPixel = 0.0;  ///< as wanted, or what the budget leaves of it

  /// A node that is worth drawing, and what its number of points is reckoned from.
  struct Candidate {
    SelectedNode selected;
    std::uint32_t pointCount = 0;  ///< of the whole node
    bool root = false, leaf = false;
    double wanted = 0.0;        ///< W of selectNodes(), points a square metre
    double given = 0.0;         ///< D
    double areaPerPoint = 0.0;  ///< σ²
    double density() const;     ///< points a square metre, the node's own and its parents', when drawn whole
  };
  std::vector<Candidate> heap, taken;  ///< scratch
};

/// Chooses what to draw for a view, best first, as Kanzok 2015, 3.2.2 with the layered density of 3.1: the contour's
/// projected area in pixels times the wanted points a pixel is the number of points, less what its ancestors put there
/// already. With q = pointsPerPixel, p = pixels a metre at the contour's nearest visible point, facing = silhouette /
/// largest face of the contour, spacing s and N points in the node:
///
///   wanted      W = q p² facing                points a square metre of the surface
///   node's own  1/σ²,  σ² = min(s², faceArea/N)   density of the whole node (Kanzok's area bounds it)
///   given       D = sum of 1/σ² over the ancestors
///   taken when  W > D;  points = N clamp((W - D) σ², 1/N, 1);  priority = W / D
///
/// (linear nodes: σ² = length * max(width, 1/p) / N, so that a wire gets its q p length points.) The count is
/// continuous in the view: a child enters with its first point. Where that is more than the budget, q is lowered until
/// it is not: the whole picture gets thinner by the same share, instead of some nodes being drawn in full and their
/// neighbours not at all. Pure; the same arguments give the same result on any machine with IEEE doubles. Never throws.
///
/// `reach` is HierarchyIndex::reach, or empty for stores whose contours hold everything below them. `depth`, where
/// there is one, is of the same view: what it hides is left out, and all below it.
void selectNodes(const Hierarchy& hierarchy, std::span<const float> reach, const View& view, const CoarseDepth* depth,
                 const SelectionOptions& options, Selection& out);
void selectNodes(const Hierarchy& hierarchy, std::span<const float> reach, const View& view,
                 const SelectionOptions& options, Selection& out);
void selectNodes(const Hierarchy& hierarchy, const View& view, const SelectionOptions& options, Selection& out);

/// σ² of selectNodes(): square metres that one point of the whole node stands for. What is thinner than a pixel still
/// fills a pixel's width, so a wire gets a point for each pixel of its length. The node has points.
double areaPerPoint(const NodeRecord& record, const Contour& contour, const ContourOnScreen& screen);

}  // namespace strata
