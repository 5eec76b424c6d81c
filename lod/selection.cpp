#include "lod/selection.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>

#include "lod/clip_region.h"

namespace strata {
namespace {

Precision precisionFor(double extentPx) {
  if (extentPx < kPixelsAt10Bits) return Precision::low10;
  return extentPx < kPixelsAt20Bits ? Precision::medium20 : Precision::full30;
}

/// The order of the heap. The index decides between equal priorities, so that the result does not depend on how the
/// standard library keeps heaps.
bool lessUrgent(const Selection::Candidate& a, const Selection::Candidate& b) {
  if (a.selected.priority != b.selected.priority) return a.selected.priority < b.selected.priority;
  return a.selected.node > b.selected.node;
}

/// How many points of a node to draw to reach `share` of the wanted density; 0 leaves the node out.
std::uint32_t pointsAt(const Selection::Candidate& node, double share) {
  if (!node.root && share < 1.0 && !(share * static_cast<double>(node.selected.priority) > 1.0)) return 0;
  const double fraction = (share * node.wanted - node.given) * node.areaPerPoint;
  // Written so that NaN counts as 0.
  const double points = (fraction > 0.0 ? std::min(fraction, 1.0) : 0.0) * node.pointCount;
  if (!node.root && node.leaf && points < 0.5) return 0;
  return std::min(std::max(static_cast<std::uint32_t>(points + 0.5), 1u), node.pointCount);
}

std::uint64_t pointsAt(std::span<const Selection::Candidate> nodes, double share) {
  std::uint64_t points = 0;
  for (const Selection::Candidate& node : nodes) points += pointsAt(node, share);
  return points;
}

/// The share of the wanted density, below `high`, that comes close to the budget without exceeding it. The number of
/// points grows with the share, so it is found by bisection, of the logarithm: shares may differ by many powers of ten.
double shareWithin(std::span<const Selection::Candidate> nodes, std::uint64_t budget, double high) {
  constexpr double kLeast = 1e-60;  // any smaller share leaves one point even of a node around the eye
  constexpr double kUnused = 1e-3;  // share of the budget that may be left; the caller gives it out
  constexpr int kMostSteps = 40;
  double low = 0.5 * high;
  while (pointsAt(nodes, low) > budget) {
    high = low;
    low *= 0.25;
    if (low < kLeast) return 0.0;
  }
  const auto enough = static_cast<std::uint64_t>(static_cast<double>(budget) * (1.0 - kUnused));
  for (int step = 0; step < kMostSteps; ++step) {
    const double middle = std::sqrt(low * high);
    const std::uint64_t points = pointsAt(nodes, middle);
    (points > budget ? high : low) = middle;
    if (points <= budget && points >= enough) break;
  }
  return low;
}

/// Looks at nodes for one view. The tests come in the order of their cost; occlusion, the dearest, comes last.
class Walk {
 public:
  Walk(const SelectionTree& tree, const View& view, const CoarseDepth* depth, const SelectionOptions& options)
      : nodes_(tree.hierarchy.nodes), reach_(tree.reach), volume_(view), depth_(depth), options_(options) {}

  /// The node as a candidate, if it is in view and its ancestors do not give all that is wanted there.
  std::optional<Selection::Candidate> look(std::uint32_t node, double given, float parentPriority,
                                           std::vector<std::uint32_t>& hidden) const {
    const NodeRecord& record = nodes_[node];
    const Contour contour = contourOf(record);
    const double reach = reach_.empty() ? 0.0 : static_cast<double>(reach_[node]);
    if (!contourInView(contour, reach, volume_) || !mayBeLeftBy(options_.shown.clip, contour, reach))
      return std::nullopt;

    const ContourOnScreen screen = projectContour(contour, reach, volume_);
    const double wanted = options_.pointsPerPixel * screen.pixelsPerMetre * screen.pixelsPerMetre * screen.facing;
    const bool isRoot = node == 0;
    if (!isRoot && (!(wanted > given) || screen.extentPx < options_.minimumPixels)) return std::nullopt;

    Selection::Candidate candidate;
    candidate.pointCount = record.pointCount;
    candidate.root = isRoot;
    candidate.leaf = record.childMask == 0;
    candidate.wanted = wanted;
    candidate.given = given;
    if (record.pointCount > 0) candidate.areaPerPoint = areaPerPoint(record, contour, screen);

    SelectedNode& selected = candidate.selected;
    selected.node = node;
    // Never more urgent than the parent, so that the heap gives parents first.
    selected.priority = isRoot ? parentPriority : std::min(parentPriority, static_cast<float>(wanted / given));
    selected.precision = precisionFor(screen.extentPx / volume_.cosHalfDiagonal);
    selected.pointCount = pointsAt(candidate, 1.0);
    if (candidate.leaf && !isRoot && selected.pointCount == 0) return std::nullopt;
    if (!isRoot && depth_ != nullptr && depth_->hides(contour, reach)) {
      hidden.push_back(node);
      return std::nullopt;
    }
    return candidate;
  }

  /// Pushes the children of a node that are worth drawing.
  void pushChildren(const Selection::Candidate& parent, Selection& out) const {
    const NodeRecord& record = nodes_[parent.selected.node];
    const std::size_t first = record.firstChild;
    const auto children = static_cast<std::size_t>(std::popcount(record.childMask));
    if (children == 0 || first <= parent.selected.node || first + children > nodes_.size()) return;
    for (std::size_t child = first; child < first + children; ++child) {
      ++out.tested;
      const auto candidate =
          look(static_cast<std::uint32_t>(child), parent.density(), parent.selected.priority, out.hidden);
      if (!candidate) continue;
      out.heap.push_back(*candidate);
      std::push_heap(out.heap.begin(), out.heap.end(), lessUrgent);
    }
  }

 private:
  const std::vector<NodeRecord>& nodes_;
  std::span<const float> reach_;
  ViewVolume volume_;
  const CoarseDepth* depth_;
  const SelectionOptions& options_;
};

/// Fills the result with the nodes taken. If all `wanted` points are more than the budget, every node is thinned by the
/// same share, and the points that rounding leaves are given out to the most urgent nodes.
void emit(std::uint64_t wanted, std::uint64_t budget, double highestShare, Selection& out) {
  out.budgetReached = wanted > budget;
  const double share = out.budgetReached ? shareWithin(out.taken, budget, highestShare) : 1.0;
  out.pointsPerPixel *= share;
  for (const Selection::Candidate& candidate : out.taken) {
    SelectedNode selected = candidate.selected;
    selected.pointCount = out.budgetReached ? pointsAt(candidate, share) : selected.pointCount;
    const bool reached = candidate.root || !out.budgetReached || share * static_cast<double>(selected.priority) > 1.0;
    if (!reached || (candidate.leaf && !candidate.root && selected.pointCount == 0)) continue;
    out.pointCount += selected.pointCount;
    out.nodes.push_back(selected);
  }
  if (!out.budgetReached) return;
  for (std::size_t i = 0, n = 0; i < out.taken.size() && n < out.nodes.size(); ++i) {
    if (out.taken[i].selected.node != out.nodes[n].node) continue;
    SelectedNode& selected = out.nodes[n++];
    const auto more = static_cast<std::uint32_t>(
        std::min<std::uint64_t>(out.taken[i].pointCount - selected.pointCount, budget - out.pointCount));
    selected.pointCount += more;
    out.pointCount += more;
  }
}

}  // namespace

double areaPerPoint(const NodeRecord& record, const Contour& contour, const ContourOnScreen& screen) {
  if (record.contourClass == static_cast<std::uint8_t>(ContourClass::linear)) {
    std::array<double, 3> half = contour.half;
    std::sort(half.begin(), half.end());
    return 2.0 * half[2] * std::max(2.0 * half[1], 1.0 / screen.pixelsPerMetre) / record.pointCount;
  }
  const double spacing = static_cast<double>(record.spacing);
  const double byArea = screen.faceArea / record.pointCount;
  return std::isfinite(spacing) && spacing >= 0.0 ? std::min(spacing * spacing, byArea) : byArea;
}

double Selection::Candidate::density() const {
  if (pointCount == 0) return given;
  return given + (areaPerPoint > 0.0 ? 1.0 / areaPerPoint : std::numeric_limits<double>::infinity());
}

void selectNodes(const SelectionTree& tree, const View& view, const CoarseDepth* depth, const SelectionOptions& options,
                 Selection& out) {
  out.nodes.clear();
  out.heap.clear();
  out.taken.clear();
  out.hidden.clear();
  out.pointCount = 0;
  out.tested = 0;
  out.occluded = 0;
  out.budgetReached = false;
  out.pointsPerPixel = options.pointsPerPixel;
  const std::uint64_t budget = std::min(options.pointBudget, SelectionOptions::kMaxPointBudget);
  if (tree.hierarchy.nodes.empty()) return;
  if (budget == 0) {
    out.budgetReached = true;
    return;
  }

  const Walk walk(tree, view, depth, options);
  out.tested = 1;
  if (const auto root = walk.look(0, 0.0, std::numeric_limits<float>::max(), out.hidden)) out.heap.push_back(*root);
  double highestShare = 1.0;
  std::uint64_t wanted = 0;
  std::size_t nextCheck = 0;
  while (!out.heap.empty()) {
    std::pop_heap(out.heap.begin(), out.heap.end(), lessUrgent);
    const Selection::Candidate candidate = out.heap.back();
    out.heap.pop_back();
    if (wanted > budget && out.taken.size() >= nextCheck) {
      // At this share neither the candidate nor any later one has a point. If those taken fill the budget at it, the
      // walk can end. The check costs a pass over all of them, so it is made at each growth by an eighth.
      const double share = 1.0 / static_cast<double>(candidate.selected.priority);
      if (pointsAt(out.taken, share) >= budget) {
        highestShare = share;
        break;
      }
      nextCheck = out.taken.size() + out.taken.size() / 8 + 1;
    }
    out.taken.push_back(candidate);
    wanted += candidate.selected.pointCount;
    walk.pushChildren(candidate, out);
  }
  out.occluded = static_cast<std::uint32_t>(out.hidden.size());
  emit(wanted, budget, highestShare, out);
}

void selectNodes(const SelectionTree& tree, const View& view, const SelectionOptions& options, Selection& out) {
  selectNodes(tree, view, nullptr, options, out);
}

}  // namespace strata
