#include "converter/build/merge.h"

#include <algorithm>
#include <cstring>
#include <memory>
#include <span>
#include <utility>

#include "converter/build/chunk_builder.h"
#include "converter/build/in_order.h"
#include "converter/build/lod_colour.h"

namespace strata {
namespace {

/// A node whose points its parent may still take.
struct OpenNode {
  NodeKey key;
  std::vector<std::byte> points;  ///< topPointStride() bytes each
  std::vector<SubtreeShape> children;
};

using Tops = std::vector<ChunkTop>::iterator;

/// Calls `see(child, first, last)` with the tops inside each child of the cell that holds all of these.
template <typename See>
void forEachChild(NodeKey cell, Tops first, Tops last, See&& see) {
  for (int octant = 0; octant < 8; ++octant) {
    const NodeKey child = cell.child(octant);
    const Tops end = std::find_if(first, last, [&](const ChunkTop& t) { return !child.isAncestorOf(t.key); });
    if (first != end) see(child, first, end);
    first = end;
  }
}

class Merger {
 public:
  Merger(const BuildFrame& frame, const Spill& spill, const ConvertControl& control, ChunkScratch& scratch)
      : frame_(frame), stride_(topPointStride(frame)), spill_(spill), control_(control), scratch_(scratch) {}

  /// The top node of a cell, from the tops inside it.
  OpenNode merge(NodeKey cell, Tops first, Tops last) {
    control_.checkStop();
    if (first->key == cell) {
      OpenNode top{cell, {}, std::move(first->children)};
      spill_.get(first->points, top.points);
      return top;
    }
    std::vector<OpenNode> children;
    forEachChild(cell, first, last,
                 [&](NodeKey child, Tops begin, Tops end) { children.push_back(merge(child, begin, end)); });
    return takeFromChildren(cell, std::move(children));
  }

  /// Finishes the node as it is; returns its shape.
  SubtreeShape close(const OpenNode& node) {
    const CellFrame cell(frame_, node.key);
    std::vector<std::int32_t> columns[3];
    const LevelOrder levels =
        sampleNode(frame_.sampling, localPoints(cell, {&node, 1}, columns), LevelOrder::kAll, scratch_.tree);
    Moments moments = cell.world(levels.moments);
    for (const SubtreeShape& child : node.children) moments.add(child.moments);
    NodePoints points;
    gather(frame_, node.points.data(), stride_, levels.order, points);
    if (frame_.averages() && !node.children.empty())
      for (const std::uint32_t i : levels.order)
        points.drawColours.push_back(representedAt(node.points.data() + i * stride_).colour);
    FinishedNode finished = finishNode(frame_, node.key, points, levels, moments, node.children, scratch_.encode);
    finished_.push_back(std::move(finished.node));
    return finished.shape;
  }
  /// The nodes finished since the last call, in order.
  std::vector<BuiltNode> takeFinished() { return std::exchange(finished_, {}); }

 private:
  /// The own points of all `nodes`, one after the other, in `columns`.
  LocalPoints localPoints(const CellFrame& cell, std::span<const OpenNode> nodes,
                          std::vector<std::int32_t> (&columns)[3]) const {
    for (const OpenNode& node : nodes) appendLocal(frame_, cell, node.points, stride_, columns);
    return {{columns[0], columns[1], columns[2]}, cell.step};
  }

  OpenNode takeFromChildren(NodeKey key, std::vector<OpenNode> children) {
    const CellFrame cell(frame_, key);
    std::vector<std::int32_t> columns[3];
    const LocalPoints points = localPoints(cell, children, columns);
    // Half at most, so that a chain of only children does not empty the lower ones.
    const std::size_t capacity =
        std::min<std::size_t>(frame_.info.nodePoints, std::max<std::size_t>(points.count() / 2, 1));
    const LevelOrder levels = sampleNode(frame_.sampling, points, capacity, scratch_.tree);
    std::vector<Represented> represented;
    if (frame_.averages()) {
      std::vector<Represented> all;
      for (const OpenNode& child : children)
        for (std::size_t at = 0; at < child.points.size(); at += stride_)
          all.push_back(representedAt(child.points.data() + at));
      represented = averaged(representedBy(scratch_.tree, all.size(), levels.order), levels.order.size(),
                             [&](std::size_t i) { return all[i]; });
    }
    OpenNode parent{key, std::vector<std::byte>(levels.order.size() * stride_), {}};
    std::vector<std::uint32_t> place(points.count(), kLeft);
    for (std::size_t i = 0; i < levels.order.size(); ++i) place[levels.order[i]] = static_cast<std::uint32_t>(i);
    std::size_t global = 0;
    for (OpenNode& child : children) {
      std::size_t to = 0;
      for (std::size_t at = 0; at < child.points.size(); at += stride_, ++global) {
        const std::byte* record = child.points.data() + at;
        if (place[global] == kLeft) {
          std::memmove(child.points.data() + to, record, stride_);
          to += stride_;
          continue;
        }
        std::byte* kept = parent.points.data() + place[global] * stride_;
        std::memcpy(kept, record, stride_);
        if (frame_.averages())
          std::memcpy(kept + frame_.format.stride(), &represented[place[global]], sizeof(Represented));
      }
      child.points.resize(to);
      if (!child.points.empty() || !child.children.empty()) parent.children.push_back(close(child));
    }
    return parent;
  }

  Represented representedAt(const std::byte* record) const {
    Represented one;
    std::memcpy(&one, record + frame_.format.stride(), sizeof one);
    return one;
  }

  static constexpr std::uint32_t kLeft = 0xffffffff;  ///< in no parent

  const BuildFrame& frame_;
  const std::size_t stride_;
  const Spill& spill_;
  const ConvertControl& control_;
  ChunkScratch& scratch_;
  std::vector<BuiltNode> finished_;
};

/// A cell and the tops inside it.
struct Group {
  NodeKey cell;
  Tops first, last;

  std::uint64_t bytes() const {
    std::uint64_t bytes = 0;
    for (Tops top = first; top != last; ++top) bytes += top->points.bytes;
    return bytes;
  }
};

/// The largest cells that hold a few tops each, in Morton order.
void findGroups(NodeKey cell, Tops first, Tops last, std::vector<Group>& groups) {
  constexpr std::ptrdiff_t kMostTops = 8;  // fewer, and a cell with a chunk in each octant could not be merged
  if (last - first <= kMostTops)
    groups.push_back({cell, first, last});
  else
    forEachChild(cell, first, last,
                 [&](NodeKey child, Tops begin, Tops end) { findGroups(child, begin, end, groups); });
}

struct MergedGroup {
  OpenNode top;
  std::vector<BuiltNode> nodes;
};

}  // namespace

void mergeChunks(const BuildFrame& frame, std::vector<ChunkTop> tops, std::uint64_t pointsAtOnce, int threads,
                 Spill& spill, NodeSink& sink, const ConvertControl& control) {
  ScratchPool scratches;
  for (bool root = false; !root;) {
    std::vector<Group> groups;
    findGroups(NodeKey{}, tops.begin(), tops.end(), groups);
    root = groups.size() == 1;
    std::vector<ChunkTop> merged;
    InOrder<MergedGroup> cells;
    cells.pointsAtOnce = pointsAtOnce;
    cells.end = groups.size();
    cells.size = [&](std::size_t index) { return groups[index].bytes() / topPointStride(frame); };
    cells.begin = [](std::size_t) { return MergedGroup{}; };
    cells.build = [&](std::size_t index, MergedGroup& out) {
      const Group& group = groups[index];
      if (!root && group.last - group.first == 1) return;
      std::unique_ptr<ChunkScratch> scratch = scratches.lend();
      Merger merger(frame, spill, control, *scratch);
      out.top = merger.merge(group.cell, group.first, group.last);
      if (root) merger.close(out.top);
      out.nodes = merger.takeFinished();
      scratches.giveBack(std::move(scratch));
    };
    cells.finish = [&](std::size_t index, MergedGroup& out) {
      const Group& group = groups[index];
      sink.write(std::move(out.nodes));
      if (root) return;
      if (group.last - group.first == 1) {
        merged.push_back(std::move(*group.first));
        return;
      }
      merged.push_back({group.cell, spill.put(out.top.points), std::move(out.top.children)});
    };
    cells.run(static_cast<std::size_t>(threads));
    tops = std::move(merged);
  }
}

}  // namespace strata
