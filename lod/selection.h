#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "core/draw_options.h"
#include "core/node_data.h"
#include "core/view.h"
#include "io/store/store.h"
#include "lod/coarse_depth.h"
#include "lod/contour.h"

namespace strata {

struct SelectionOptions {
  static constexpr std::uint64_t kMaxPointBudget = 0xfffffffeu;  ///< point ids of a picture have 32 bits

  double pointsPerPixel = 1.8;  ///< wanted density of one layer of surface on the screen; docs/lod.md says why
  std::uint64_t pointBudget = 10'000'000;  ///< never more points than this; at most kMaxPointBudget
  double minimumPixels = 1.0;              ///< a node whose longest side is shorter is left out; its parent is drawn

  OcclusionOptions occlusion{};  ///< how the streamer fills the coarse depth
  /// The planes to read. Its clip leaves out nodes whose points are all clipped away, which then do not count; it does
  /// not cut other nodes.
  Shown shown{};
  /// A node that was in view all along takes at least this long from its first point to all of them; see Fade.
  double fadeSeconds = 0.2;

  bool operator==(const SelectionOptions&) const = default;
};

struct SelectedNode {
  std::uint32_t node = 0;                   ///< index in the Hierarchy
  std::uint32_t pointCount = 0;             ///< prefix of the node's level order
  float priority = 0.0f;                    ///< wanted density / density that the ancestors give, at least 1
  Precision precision = Precision::full30;  ///< enough to place points within half a pixel (Schütz 2022, 3.3)
};

/// The result of selectNodes() and the memory of its walk, so that a Selection used again allocates nothing.
struct Selection {
  std::vector<SelectedNode> nodes;    ///< most urgent first; parents before their children
  std::uint64_t pointCount = 0;       ///< sum over nodes
  std::uint32_t tested = 0;           ///< contours looked at
  std::uint32_t occluded = 0;         ///< nodes left out because something hides them, with everything below them
  std::vector<std::uint32_t> hidden;  ///< indices of those nodes, in no order
  bool budgetReached = false;
  double pointsPerPixel = 0.0;  ///< the wanted density, or what the budget leaves of it

  /// A node that is worth drawing, and the values that its number of points follows from.
  struct Candidate {
    SelectedNode selected;
    std::uint32_t pointCount = 0;  ///< points of the whole node
    bool root = false, leaf = false;
    double wanted = 0.0;        ///< W of selectNodes(), points per square metre
    double given = 0.0;         ///< D
    double areaPerPoint = 0.0;  ///< σ²
    /// Points per square metre that the node and its ancestors give together when they are drawn whole.
    double density() const;
  };
  std::vector<Candidate> heap, taken;  ///< memory of the walk
};

/// The nodes that a selection walks over. It refers to its arguments.
struct SelectionTree {
  SelectionTree(const Hierarchy& walked, std::span<const float> reaches = {}) : hierarchy(walked), reach(reaches) {}

  const Hierarchy& hierarchy;
  /// HierarchyIndex::reach. Empty for a store in which each contour holds everything below its node.
  std::span<const float> reach;
};

/// Chooses what to draw for a view, the best first (Kanzok 2015, 3.2.2, with the layered density of 3.1): a node gets
/// the area of its contour in pixels, times the wanted points per pixel, less what its ancestors put there already.
/// With q = pointsPerPixel, p = pixels per metre at the contour's nearest visible point, facing = silhouette / largest
/// face of the contour, spacing s and N points in the node:
///
///   wanted      W = q p² facing                points per square metre of the surface
///   node's own  1/σ²,  σ² = min(s², faceArea/N)   density of the whole node (Kanzok's area bounds it)
///   given       D = sum of 1/σ² over the ancestors
///   taken when  W > D;  points = N clamp((W - D) σ², 1/N, 1);  priority = W / D
///
/// (linear nodes: σ² = length * max(width, 1/p) / N, so that a wire gets its q p length points.) The number of points
/// is continuous in the view: a child enters with its first point. When all of it is more than the budget, q is lowered
/// until it is not. Then the whole picture gets thinner by the same share; Kanzok draws some nodes in full and others,
/// beside them, not at all. Pure; the same arguments give the same result on any machine with IEEE doubles. Never
/// throws.
///
/// `depth` may be null, or has been drawn for the same view; a node that it hides is left out, with everything below
/// it.
void selectNodes(const SelectionTree& tree, const View& view, const CoarseDepth* depth, const SelectionOptions& options,
                 Selection& out);
void selectNodes(const SelectionTree& tree, const View& view, const SelectionOptions& options, Selection& out);

/// σ² of selectNodes(): square metres for each point of the whole node, which has points. A node that is thinner than a
/// pixel still fills a pixel's width, so a wire gets a point for each pixel of its length.
double areaPerPoint(const NodeRecord& record, const Contour& contour, const ContourOnScreen& screen);

}  // namespace strata
