#include "converter/merge.h"

#include <algorithm>
#include <cstring>

namespace strata {
namespace {

/// A node whose points its parent may still take.
struct OpenNode {
  NodeKey key;
  std::vector<std::byte> points;
  std::vector<SubtreeShape> children;
};

class Merger {
 public:
  Merger(const BuildFrame& frame, Spill& spill, NodeSink& sink, const ConvertControl& control)
      : frame_(frame), spill_(spill), sink_(sink), control_(control) {}

  OpenNode merge(NodeKey cell, std::vector<ChunkTop>::iterator first, std::vector<ChunkTop>::iterator last) {
    control_.checkStop();
    if (first->key == cell) {
      OpenNode top{cell, {}, std::move(first->children)};
      spill_.take(first->points, top.points);
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
    FinishedNode finished = finishNode(frame_, node.key, node.points, node.children);
    std::vector<BuiltNode> one;
    one.push_back(std::move(finished.node));
    sink_.write(std::move(one));
    return finished.shape;
  }

 private:
  OpenNode takeFromChildren(NodeKey cell, std::vector<OpenNode> children) {
    const std::size_t stride = frame_.format.stride();
    std::vector<std::uint64_t> keys;
    for (const OpenNode& child : children)
      for (std::size_t at = 0; at < child.points.size(); at += stride)
        keys.push_back(frame_.key(cell, child.points.data() + at));
    // Half at most, so that a chain of only children does not empty the lower ones.
    const std::size_t capacity =
        std::min<std::size_t>(frame_.info.nodePoints, std::max<std::size_t>(keys.size() / 2, 1));
    const std::vector<std::uint32_t> kept = selectRepresentatives({keys, frame_.keyLevels(cell)}, capacity);
    OpenNode parent{cell, {}, {}};
    parent.points.reserve(kept.size() * stride);
    std::size_t next = 0, global = 0;
    for (OpenNode& child : children) {
      std::size_t to = 0;
      for (std::size_t at = 0; at < child.points.size(); at += stride, ++global) {
        const std::byte* record = child.points.data() + at;
        if (next < kept.size() && kept[next] == global) {
          parent.points.insert(parent.points.end(), record, record + stride);
          ++next;
        } else {
          std::memmove(child.points.data() + to, record, stride);
          to += stride;
        }
      }
      child.points.resize(to);
      if (!child.points.empty() || !child.children.empty()) parent.children.push_back(close(child));
    }
    return parent;
  }

  const BuildFrame& frame_;
  Spill& spill_;
  NodeSink& sink_;
  const ConvertControl& control_;
};

}  // namespace

void mergeChunks(const BuildFrame& frame, std::vector<ChunkTop> tops, Spill& spill, NodeSink& sink,
                 const ConvertControl& control) {
  Merger merger(frame, spill, sink, control);
  merger.close(merger.merge(NodeKey{}, tops.begin(), tops.end()));
}

}  // namespace strata
