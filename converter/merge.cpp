#include "converter/merge.h"

#include <algorithm>
#include <cstring>
#include <span>

#include "converter/chunk_builder.h"
#include "converter/lod_colour.h"

namespace strata {
namespace {

/// A node whose points its parent may still take.
struct OpenNode {
  NodeKey key;
  std::vector<std::byte> points;  ///< topPointStride() bytes each
  std::vector<SubtreeShape> children;
};

class Merger {
 public:
  Merger(const BuildFrame& frame, Spill& spill, NodeSink& sink, const ConvertControl& control)
      : frame_(frame), stride_(topPointStride(frame)), spill_(spill), sink_(sink), control_(control) {}

  OpenNode merge(NodeKey cell, std::vector<ChunkTop>::iterator first, std::vector<ChunkTop>::iterator last) {
    control_.checkStop();
    if (first->key == cell) {
      OpenNode top{cell, {}, std::move(first->children)};
      spill_.get(first->points, top.points);
      return top;
    }
    std::vector<OpenNode> children;
    for (int octant = 0; octant < 8; ++octant) {
      const NodeKey child = cell.child(octant);
      const auto end = std::find_if(first, last, [&](const ChunkTop& t) { return !child.isAncestorOf(t.key); });
      if (first != end) children.push_back(merge(child, first, end));
      first = end;
    }
    return takeFromChildren(cell, std::move(children));
  }

  /// Writes the node as it is; returns its shape.
  SubtreeShape close(const OpenNode& node) {
    const CellFrame cell(frame_, node.key);
    std::vector<std::int32_t> columns[3];
    const LevelOrder levels =
        sampleNode(frame_.sampling, localPoints(cell, {&node, 1}, columns), LevelOrder::kAll, scratch_);
    Moments moments = cell.world(levels.moments);
    for (const SubtreeShape& child : node.children) moments.add(child.moments);
    NodePoints points;
    gather(frame_, node.points.data(), stride_, levels.order, points);
    if (frame_.averages() && !node.children.empty())
      for (const std::uint32_t i : levels.order)
        points.drawColours.push_back(representedAt(node.points.data() + i * stride_).colour);
    FinishedNode finished = finishNode(frame_, node.key, points, levels, moments, node.children, encodeScratch_);
    std::vector<BuiltNode> one;
    one.push_back(std::move(finished.node));
    sink_.write(std::move(one));
    return finished.shape;
  }

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
    const LevelOrder levels = sampleNode(frame_.sampling, points, capacity, scratch_);
    std::vector<Represented> represented;
    if (frame_.averages()) {
      std::vector<Represented> all;
      for (const OpenNode& child : children)
        for (std::size_t at = 0; at < child.points.size(); at += stride_)
          all.push_back(representedAt(child.points.data() + at));
      represented = averaged(representedBy(scratch_, all.size(), levels.order), levels.order.size(),
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
  Spill& spill_;
  NodeSink& sink_;
  const ConvertControl& control_;
  TreeScratch scratch_;
  EncodeScratch encodeScratch_;
};

}  // namespace

void mergeChunks(const BuildFrame& frame, std::vector<ChunkTop> tops, Spill& spill, NodeSink& sink,
                 const ConvertControl& control) {
  Merger merger(frame, spill, sink, control);
  merger.close(merger.merge(NodeKey{}, tops.begin(), tops.end()));
}

}  // namespace strata
