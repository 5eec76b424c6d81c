#include "lod/selection.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>

#include "lod/contour.h"

namespace strata {
namespace {

/// Pixels that a node may span before 10 bits a coordinate are too coarse (Schütz 2022, 3.3). Coordinates span a power
/// of two of grid steps, up to twice the points' own box, so a step is at most one pixel and the error half of that.
constexpr double kPixelsAt10Bits = 500.0;
constexpr double kPixelsAt20Bits = kPixelsAt10Bits * 1024.0;

Precision precisionFor(double extentPx) {
  if (extentPx < kPixelsAt10Bits) return Precision::low10;
  return extentPx < kPixelsAt20Bits ? Precision::medium20 : Precision::full30;
}

/// Max-heap order; ties go to the lower index, so that the order does not hang on the heap's implementation.
bool lessUrgent(const Selection::Candidate& a, const Selection::Candidate& b) {
  if (a.selected.priority != b.selected.priority) return a.selected.priority < b.selected.priority;
  return a.selected.node > b.selected.node;
}

/// Square metres that one point of the whole node stands for.
double areaPerPoint(const NodeRecord& record, const Contour& contour, double faceArea) {
  const double spacing = static_cast<double>(record.spacing);
  const bool known = std::isfinite(spacing) && spacing >= 0.0;
  if (record.contourClass == static_cast<std::uint8_t>(ContourClass::linear)) {
    const double length = 2.0 * std::max({contour.half[0], contour.half[1], contour.half[2]});
    const double step = known ? spacing : length / record.pointCount;
    return step * step;
  }
  const double byArea = faceArea / record.pointCount;
  return known ? std::min(spacing * spacing, byArea) : byArea;
}

class Walk {
 public:
  Walk(const Hierarchy& hierarchy, std::span<const float> reach, const View& view, const SelectionOptions& options)
      : nodes_(hierarchy.nodes), reach_(reach), volume_(view), options_(options) {}

  /// The node as a candidate, if it is in view and its parents do not give all that is wanted there.
  std::optional<Selection::Candidate> look(std::uint32_t node, double given, float parentPriority) const {
    const NodeRecord& record = nodes_[node];
    const Contour contour = contourOf(record);
    const double reach = reach_.empty() ? 0.0 : static_cast<double>(reach_[node]);
    if (!contourInView(contour, reach, volume_)) return std::nullopt;

    const ContourOnScreen screen = projectContour(contour, reach, volume_);
    const double wanted = options_.pointsPerPixel * screen.pixelsPerMetre * screen.pixelsPerMetre * screen.facing;
    const bool isRoot = node == 0;
    if (!isRoot && (!(wanted > given) || screen.extentPx < options_.minimumPixels)) return std::nullopt;

    Selection::Candidate candidate;
    candidate.density = given;
    double fraction = 0.0;
    if (record.pointCount > 0) {
      const double area = areaPerPoint(record, contour, screen.faceArea);
      candidate.density += area > 0.0 ? 1.0 / area : std::numeric_limits<double>::infinity();
      fraction = record.contourClass == static_cast<std::uint8_t>(ContourClass::linear)
                     ? (std::sqrt(wanted) - std::sqrt(given)) * std::sqrt(area)
                     : (wanted - given) * area;
    }
    // Written so that what is not a number counts as nothing.
    const double points = (fraction > 0.0 ? std::min(fraction, 1.0) : 0.0) * record.pointCount;
    if (!isRoot && record.childMask == 0 && points < 0.5) return std::nullopt;

    SelectedNode& selected = candidate.selected;
    selected.node = node;
    selected.pointCount = std::min(std::max(static_cast<std::uint32_t>(points + 0.5), 1u), record.pointCount);
    selected.priority = isRoot ? parentPriority : std::min(parentPriority, static_cast<float>(wanted / given));
    selected.precision = precisionFor(screen.extentPx / volume_.cosHalfDiagonal);
    return candidate;
  }

  /// Pushes what is worth drawing below a node.
  void pushChildren(const Selection::Candidate& parent, Selection& out) const {
    const NodeRecord& record = nodes_[parent.selected.node];
    const std::size_t first = record.firstChild;
    const auto children = static_cast<std::size_t>(std::popcount(record.childMask));
    if (children == 0 || first <= parent.selected.node || first + children > nodes_.size()) return;
    for (std::size_t child = first; child < first + children; ++child) {
      ++out.tested;
      const auto candidate = look(static_cast<std::uint32_t>(child), parent.density, parent.selected.priority);
      if (!candidate) continue;
      out.heap.push_back(*candidate);
      std::push_heap(out.heap.begin(), out.heap.end(), lessUrgent);
    }
  }

 private:
  const std::vector<NodeRecord>& nodes_;
  std::span<const float> reach_;
  ViewVolume volume_;
  const SelectionOptions& options_;
};

}  // namespace

void selectNodes(const Hierarchy& hierarchy, std::span<const float> reach, const View& view,
                 const SelectionOptions& options, Selection& out) {
  out.nodes.clear();
  out.heap.clear();
  out.pointCount = 0;
  out.tested = 0;
  out.budgetReached = false;
  if (hierarchy.nodes.empty()) return;

  const Walk walk(hierarchy, reach, view, options);
  const std::uint64_t budget = std::min(options.pointBudget, SelectionOptions::kMaxPointBudget);
  out.tested = 1;
  if (const auto root = walk.look(0, 0.0, std::numeric_limits<float>::max())) out.heap.push_back(*root);
  while (!out.heap.empty()) {
    std::pop_heap(out.heap.begin(), out.heap.end(), lessUrgent);
    Selection::Candidate candidate = out.heap.back();
    out.heap.pop_back();
    const std::uint64_t left = budget - out.pointCount;
    if (candidate.selected.pointCount > left) {
      out.budgetReached = true;
      if (left == 0) break;
      candidate.selected.pointCount = static_cast<std::uint32_t>(left);
    }
    out.nodes.push_back(candidate.selected);
    out.pointCount += candidate.selected.pointCount;
    if (out.budgetReached) break;
    walk.pushChildren(candidate, out);
  }
}

void selectNodes(const Hierarchy& hierarchy, const View& view, const SelectionOptions& options, Selection& out) {
  selectNodes(hierarchy, {}, view, options, out);
}

}  // namespace strata
