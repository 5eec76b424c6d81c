#include "converter/build/merge.h"

#include <algorithm>
#include <cstring>
#include <memory>
#include <span>
#include <utility>

#include "converter/build/chunk_builder.h"
#include "converter/build/in_order.h"
#include "converter/build/level_order.h"
#include "converter/build/lod_colour.h"

namespace strata {
namespace {

/// A node whose points its parent may still take.
struct OpenNode {
  NodeKey key;
  std::vector<std::byte> points;  ///< BuildContext::topPointStride() bytes each
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

/// Builds the nodes of one cell above the chunks. Used by one thread.
class Merger {
 public:
  Merger(const Conversion& conversion, const BuildContext& context, ChunkScratch& scratch)
      : conversion_(conversion), context_(context), stride_(context.topPointStride()), scratch_(scratch) {}

  /// Makes the top node of a cell from the tops inside it.
  OpenNode merge(NodeKey cell, Tops first, Tops last) {
    conversion_.control.checkStop();
    if (first->key == cell) {
      OpenNode top{cell, {}, std::move(first->children)};
      conversion_.spill.get(first->points, top.points);
      return top;
    }
    std::vector<OpenNode> children;
    forEachChild(cell, first, last,
                 [&](NodeKey child, Tops begin, Tops end) { children.push_back(merge(child, begin, end)); });
    return takeFromChildren(cell, std::move(children));
  }

  /// Finishes the node with the points that are left in it, and returns its shape.
  SubtreeShape close(const OpenNode& node) {
    const CellCoordinates cell(context_, node.key);
    std::vector<std::int32_t> columns[3];
    const LevelOrder order = levelOrder(localPoints(cell, {&node, 1}, columns), LevelOrder::kAll, scratch_.tree);
    Moments moments = cell.world(order.moments);
    for (const SubtreeShape& child : node.children) moments.add(child.moments);
    NodePoints points;
    gather(context_, node.points.data(), stride_, order.order, points);
    if (context_.averages() && !node.children.empty())
      for (const std::uint32_t i : order.order)
        points.drawColours.push_back(representedAt(node.points.data() + i * stride_).colour);
    FinishedNode finished = finishNode(context_, {node.key, points, order, moments, node.children}, scratch_.encode);
    finished_.push_back(std::move(finished.node));
    return finished.shape;
  }
  /// The nodes finished since the last call, in order.
  std::vector<BuiltNode> takeFinished() { return std::exchange(finished_, {}); }

 private:
  /// The own points of all `nodes`, one after the other, in `columns`.
  LocalPoints localPoints(const CellCoordinates& cell, std::span<const OpenNode> nodes,
                          std::vector<std::int32_t> (&columns)[3]) const {
    for (const OpenNode& node : nodes) appendLocal(context_, cell, node.points, stride_, columns);
    return {{columns[0], columns[1], columns[2]}, cell.step};
  }

  OpenNode takeFromChildren(NodeKey key, std::vector<OpenNode> children) {
    const CellCoordinates cell(context_, key);
    std::vector<std::int32_t> columns[3];
    const LocalPoints points = localPoints(cell, children, columns);
    // Half at most, so that a chain of only children does not empty the lower ones.
    const std::size_t capacity =
        std::min<std::size_t>(context_.info.nodePoints, std::max<std::size_t>(points.count() / 2, 1));
    const LevelOrder order = levelOrder(points, capacity, scratch_.tree);
    std::vector<Represented> represented;
    if (context_.averages()) {
      std::vector<Represented> all;
      for (const OpenNode& child : children)
        for (std::size_t at = 0; at < child.points.size(); at += stride_)
          all.push_back(representedAt(child.points.data() + at));
      represented = averaged(representedBy(scratch_.tree, all.size(), order.order), order.order.size(),
                             [&](std::size_t i) { return all[i]; });
    }
    OpenNode parent{key, std::vector<std::byte>(order.order.size() * stride_), {}};
    // A point goes to the parent, or stays with its child: the others move together there.
    std::vector<std::uint32_t> inParent(points.count(), kStays);
    for (std::size_t i = 0; i < order.order.size(); ++i) inParent[order.order[i]] = static_cast<std::uint32_t>(i);
    std::size_t index = 0;  // among the points of all children
    for (OpenNode& child : children) {
      std::size_t to = 0;
      for (std::size_t at = 0; at < child.points.size(); at += stride_, ++index) {
        const std::byte* record = child.points.data() + at;
        if (inParent[index] == kStays) {
          std::memmove(child.points.data() + to, record, stride_);
          to += stride_;
          continue;
        }
        std::byte* kept = parent.points.data() + inParent[index] * stride_;
        std::memcpy(kept, record, stride_);
        if (context_.averages())
          std::memcpy(kept + context_.format.stride(), &represented[inParent[index]], sizeof(Represented));
      }
      child.points.resize(to);
      if (!child.points.empty() || !child.children.empty()) parent.children.push_back(close(child));
    }
    return parent;
  }

  Represented representedAt(const std::byte* record) const {
    Represented one;
    std::memcpy(&one, record + context_.format.stride(), sizeof one);
    return one;
  }

  static constexpr std::uint32_t kStays = 0xffffffff;  ///< with its child

  const Conversion& conversion_;
  const BuildContext& context_;
  const std::size_t stride_;  ///< of a top point
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

/// The groups of one round as pieces of work. The last round has one group, which becomes the root.
class GroupWork {
 public:
  struct Piece {
    OpenNode top;
    std::vector<BuiltNode> nodes;
  };

  GroupWork(const Conversion& conversion, const BuildContext& context, std::vector<Group> groups, NodeSink& sink)
      : conversion_(conversion), context_(context), groups_(std::move(groups)), sink_(sink) {}

  bool isLastRound() const { return groups_.size() == 1; }
  std::size_t count() const { return groups_.size(); }
  std::vector<ChunkTop> takeTops() { return std::move(merged_); }

  std::uint64_t points(std::size_t index) const { return groups_[index].bytes() / context_.topPointStride(); }
  Piece begin(std::size_t) { return {}; }
  void build(std::size_t index, Piece& piece) {
    const Group& group = groups_[index];
    if (isUnchanged(group)) return;
    std::unique_ptr<ChunkScratch> scratch = scratches_.lend();
    Merger merger(conversion_, context_, *scratch);
    piece.top = merger.merge(group.cell, group.first, group.last);
    if (isLastRound()) merger.close(piece.top);
    piece.nodes = merger.takeFinished();
    scratches_.giveBack(std::move(scratch));
  }
  void finish(std::size_t index, Piece& piece) {
    const Group& group = groups_[index];
    sink_.write(std::move(piece.nodes));
    if (isLastRound()) return;
    if (isUnchanged(group))
      merged_.push_back(std::move(*group.first));
    else
      merged_.push_back({group.cell, conversion_.spill.put(piece.top.points), std::move(piece.top.children)});
  }

 private:
  /// A single top has nothing to be merged with in this round.
  bool isUnchanged(const Group& group) const { return !isLastRound() && group.last - group.first == 1; }

  const Conversion& conversion_;
  const BuildContext& context_;
  const std::vector<Group> groups_;
  ScratchPool scratches_;

  // Used by finish() alone.
  NodeSink& sink_;
  std::vector<ChunkTop> merged_;
};

}  // namespace

void mergeChunks(const Conversion& conversion, const BuildContext& context, std::vector<ChunkTop> tops,
                 NodeSink& sink) {
  for (bool done = false; !done;) {
    std::vector<Group> groups;
    findGroups(NodeKey{}, tops.begin(), tops.end(), groups);
    GroupWork work(conversion, context, std::move(groups), sink);
    InOrder<GroupWork> round(work, 0, work.count(), context.pointsAtOnce);
    round.run(static_cast<std::size_t>(conversion.options.threads));
    done = work.isLastRound();
    tops = work.takeTops();
  }
}

}  // namespace strata
