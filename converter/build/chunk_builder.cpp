#include "converter/build/chunk_builder.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <iterator>
#include <utility>

#include "converter/build/lod_colour.h"
#include "converter/build/slices.h"

namespace strata {
namespace {

class ChunkBuilder {
 public:
  /// `count` points are arranged in `scratch`.
  ChunkBuilder(const BuildContext& context, NodeKey cell, const CellCoordinates& coordinates, std::size_t count,
               ChunkScratch& scratch)
      : context_(context),
        cell_(cell),
        coordinates_(coordinates),
        count_(count),
        colour_(context.info),
        scratch_(scratch) {
    scratch.octants.room(count);
  }

  BuiltChunk build() {
    BuiltChunk out;
    Own own = takeOwn(cell_, 0, 0, count_);
    out.topPoints = topPoints(own);
    out.topChildren = buildChildren(cell_, 0, own, out.nodes);
    return out;
  }

 private:
  /// The points that a node keeps, and where the points of its octants begin in the other columns.
  struct Own {
    LevelOrder order;
    std::vector<std::uint32_t> records;    ///< of the points that it keeps, in their order
    std::vector<Represented> represented;  ///< empty where colours are not averaged or there are no children
    std::array<std::size_t, 9> octants{};  ///< all alike where there are no children, or slices only
    std::vector<BuiltNode> slices;
    std::vector<SubtreeShape> sliceShape;  ///< of the first slice, where there is one
  };

  std::vector<std::byte> topPoints(const Own& own) const {
    const std::size_t stride = context_.format.stride(), topStride = context_.topPointStride();
    std::vector<std::byte> packed(own.records.size() * topStride);
    for (std::size_t i = 0; i < own.records.size(); ++i) {
      std::byte* to = packed.data() + i * topStride;
      std::memcpy(to, scratch_.records.data() + own.records[i] * stride, stride);
      if (!context_.averages()) continue;
      const Represented one = own.represented.empty() ? representedAt(own.records[i]) : own.represented[i];
      std::memcpy(to + stride, &one, sizeof one);
    }
    return packed;
  }

  Represented representedAt(std::uint32_t record) const {
    return {colour_.of(scratch_.records.data() + record * context_.format.stride() + context_.format.positionBytes())};
  }

  LocalPoints localPoints(int side, std::size_t begin, std::size_t end) const {
    LocalPoints points;
    for (std::size_t axis = 0; axis < 3; ++axis)
      points.axis[axis] = {scratch_.columns[side].axis[axis].data() + begin, end - begin};
    points.step = coordinates_.step;
    return points;
  }

  bool canSplit(NodeKey key, std::size_t begin, std::size_t end, int side) const {
    if (end - begin <= context_.info.nodePoints) return false;
    if (key.level() >= NodeKey::kDeepestLevel || childBit(key) < 0) return false;
    const LocalBounds bounds = boundsOf(localPoints(side, begin, end));
    return bounds.low != bounds.high;
  }

  /// The bit of a coordinate that tells the octants of `key` apart.
  int childBit(NodeKey key) const { return coordinates_.bits - 1 - (key.level() - cell_.level()); }

  /// Orders the points [begin, end) of columns[side] and keeps the node's own; the others go to columns[1 - side],
  /// by octant, into the same range.
  Own takeOwn(NodeKey key, int side, std::size_t begin, std::size_t end) {
    Own own;
    const bool split = canSplit(key, begin, end, side);
    const bool tooMany = end - begin > std::max(context_.info.nodePoints, SliceBuilder::kMostSlicePoints);
    if (!split && tooMany) begin = takeSlices(key, side, begin, end, own);
    own.order =
        levelOrder(localPoints(side, begin, end), split ? context_.info.nodePoints : LevelOrder::kAll, scratch_.tree);
    own.records.resize(own.order.order.size());
    for (std::size_t i = 0; i < own.records.size(); ++i)
      own.records[i] = scratch_.columns[side].record[begin + own.order.order[i]];
    if (split && context_.averages())
      own.represented =
          averaged(representedBy(scratch_.tree, end - begin, own.order.order), own.records.size(),
                   [&](std::size_t i) { return representedAt(scratch_.columns[side].record[begin + i]); });
    own.octants.fill(begin);
    if (split) own.octants = divide(scratch_, side, {begin, end}, childBit(key), own.order.order);
    return own;
  }

  /// Makes slices of the points that are too many for a cell that cannot be divided, and returns where the node's own
  /// points begin.
  std::size_t takeSlices(NodeKey key, int side, std::size_t begin, std::size_t end, Own& own) {
    constexpr std::size_t kMost = SliceBuilder::kMostSlicePoints;
    const std::size_t stride = context_.format.stride();
    SliceBuilder builder(context_, key, end - begin);
    std::vector<std::byte> packed(kMost * stride);
    for (; end - begin > kMost; begin += kMost) {
      for (std::size_t i = 0; i < kMost; ++i)
        std::memcpy(packed.data() + i * stride,
                    scratch_.records.data() + scratch_.columns[side].record[begin + i] * stride, stride);
      for (BuiltNode& slice : builder.add(packed)) own.slices.push_back(std::move(slice));
    }
    own.sliceShape = builder.takeTopChildren();
    return begin;
  }

  std::vector<SubtreeShape> buildChildren(NodeKey parent, int side, Own& own, std::vector<BuiltNode>& nodes) {
    std::move(own.slices.begin(), own.slices.end(), std::back_inserter(nodes));
    std::vector<SubtreeShape> shapes = own.sliceShape;
    for (int octant = 0; octant < 8; ++octant) {
      const auto o = static_cast<std::size_t>(octant);
      if (own.octants[o] == own.octants[o + 1]) continue;
      shapes.push_back(buildNode(parent.child(octant), 1 - side, own.octants[o], own.octants[o + 1], nodes));
    }
    return shapes;
  }

  SubtreeShape buildNode(NodeKey key, int side, std::size_t begin, std::size_t end, std::vector<BuiltNode>& nodes) {
    const std::size_t index = nodes.size();  // a node comes before its children
    nodes.emplace_back();
    Own own = takeOwn(key, side, begin, end);
    const std::vector<SubtreeShape> children = buildChildren(key, side, own, nodes);
    NodePoints& points = scratch_.node;
    gather(context_, scratch_.records.data(), context_.format.stride(), own.records, points);
    for (const Represented& one : own.represented) points.drawColours.push_back(one.colour);
    Moments moments = coordinates_.world(own.order.moments);
    for (const SubtreeShape& slice : own.sliceShape) moments.add(slice.moments);
    FinishedNode finished = finishNode(context_, {key, points, own.order, moments, children}, scratch_.encode);
    nodes[index] = std::move(finished.node);
    return finished.shape;
  }

  const BuildContext& context_;
  const NodeKey cell_;
  const CellCoordinates coordinates_;
  const std::size_t count_;
  const DrawColour colour_;
  ChunkScratch& scratch_;
};

}  // namespace

BuiltChunk buildChunk(const BuildContext& context, NodeKey cell, std::vector<std::byte> points, ChunkScratch& scratch) {
  const CellCoordinates coordinates(context, cell);
  const std::size_t count = points.size() / context.format.stride();
  arrange(context, coordinates, points, scratch);
  std::vector<std::byte>().swap(points);
  return ChunkBuilder(context, cell, coordinates, count, scratch).build();
}

}  // namespace strata
