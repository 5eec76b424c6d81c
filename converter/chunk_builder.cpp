#include "converter/chunk_builder.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <iterator>
#include <utility>

#include "converter/lod_colour.h"
#include "converter/slices.h"

namespace strata {
namespace {

/// Positions and where the records are, apart from these: what the way down moves.
struct Columns {
  explicit Columns(std::size_t count) : record(count) {
    for (auto& a : axis) a.resize(count);
  }
  std::vector<std::int32_t> axis[3];
  std::vector<std::uint32_t> record;
};

int octantOf(const Columns& columns, std::size_t i, int bit) {
  return (columns.axis[0][i] >> bit & 1) << 2 | (columns.axis[1][i] >> bit & 1) << 1 | (columns.axis[2][i] >> bit & 1);
}

/// Puts the records in the order of the cells three levels down, so that what a node needs lies close together.
std::vector<std::byte> sortRecords(const BuildFrame& frame, const CellFrame& cell, std::vector<std::byte> points) {
  constexpr int kLevels = 3;
  const std::size_t stride = frame.format.stride();
  const std::size_t count = points.size() / stride;
  if (cell.bits < kLevels || count == 0) return points;
  std::vector<std::uint16_t> cells(count);
  std::array<std::size_t, (1u << (3 * kLevels)) + 1> starts{};
  for (std::size_t i = 0; i < count; ++i) {
    std::int64_t grid[3];
    frame.format.getPosition(points.data() + i * stride, grid);
    unsigned code = 0;
    for (int level = 1; level <= kLevels; ++level)
      for (const std::int64_t g : grid)
        code = code << 1 | (static_cast<unsigned>(cell.local(g) >> (cell.bits - level)) & 1u);
    cells[i] = static_cast<std::uint16_t>(code);
    ++starts[code + 1];
  }
  if (*std::max_element(starts.begin(), starts.end()) == count) return points;
  for (std::size_t c = 1; c < starts.size(); ++c) starts[c] += starts[c - 1];
  std::vector<std::byte> sorted(points.size());
  for (std::size_t i = 0; i < count; ++i)
    std::memcpy(sorted.data() + starts[cells[i]]++ * stride, points.data() + i * stride, stride);
  return sorted;
}

class ChunkBuilder {
 public:
  ChunkBuilder(const BuildFrame& frame, NodeKey cell, std::vector<std::byte> points)
      : frame_(frame),
        cell_(cell),
        cellFrame_(frame, cell),
        colour_(frame.info),
        records_(sortRecords(frame, cellFrame_, std::move(points))),
        columns_{Columns(records_.size() / frame.format.stride()), Columns(records_.size() / frame.format.stride())},
        taken_(records_.size() / frame.format.stride()) {
    for (std::size_t i = 0; i < taken_.size(); ++i) {
      std::int64_t grid[3];
      frame.format.getPosition(records_.data() + i * frame.format.stride(), grid);
      for (std::size_t axis = 0; axis < 3; ++axis) columns_[0].axis[axis][i] = cellFrame_.local(grid[axis]);
      columns_[0].record[i] = static_cast<std::uint32_t>(i);
    }
  }

  BuiltChunk build() {
    BuiltChunk out;
    Own own = takeOwn(cell_, 0, 0, taken_.size());
    out.topPoints = topPoints(own);
    out.topChildren = buildChildren(cell_, 0, own, out.nodes);
    return out;
  }

 private:
  /// What a node keeps, and where its octants' points begin in the other columns.
  struct Own {
    LevelOrder levels;
    std::vector<std::uint32_t> records;
    std::vector<Represented> represented;  ///< where colours are averaged and there are children
    std::array<std::size_t, 9> octants{};  ///< all alike: no children but slices
    std::vector<BuiltNode> slices;
    std::vector<SubtreeShape> sliceShape;  ///< none, or of the first slice
  };

  std::vector<std::byte> topPoints(const Own& own) const {
    const std::size_t stride = frame_.format.stride(), topStride = topPointStride(frame_);
    std::vector<std::byte> packed(own.records.size() * topStride);
    for (std::size_t i = 0; i < own.records.size(); ++i) {
      std::byte* to = packed.data() + i * topStride;
      std::memcpy(to, records_.data() + own.records[i] * stride, stride);
      if (!frame_.averages()) continue;
      const Represented one = own.represented.empty() ? representedAt(own.records[i]) : own.represented[i];
      std::memcpy(to + stride, &one, sizeof one);
    }
    return packed;
  }

  Represented representedAt(std::uint32_t record) const {
    return {colour_.of(records_.data() + record * frame_.format.stride() + frame_.format.positionBytes())};
  }

  LocalPoints localPoints(int side, std::size_t begin, std::size_t end) const {
    LocalPoints points;
    for (std::size_t axis = 0; axis < 3; ++axis)
      points.axis[axis] = std::span(columns_[side].axis[axis]).subspan(begin, end - begin);
    points.step = cellFrame_.step;
    return points;
  }

  bool canSplit(NodeKey key, std::size_t begin, std::size_t end, int side) const {
    if (end - begin <= frame_.info.nodePoints) return false;
    if (key.level() >= NodeKey::kDeepestLevel || childBit(key) < 0) return false;
    const LocalBounds bounds = boundsOf(localPoints(side, begin, end));
    return bounds.low != bounds.high;
  }

  /// The bit of a coordinate that tells the octants of `key` apart.
  int childBit(NodeKey key) const { return cellFrame_.bits - 1 - (key.level() - cell_.level()); }

  /// Orders the points [begin, end) of columns_[side] and keeps the node's own; the others go to columns_[1 - side],
  /// by octant, into the same range.
  Own takeOwn(NodeKey key, int side, std::size_t begin, std::size_t end) {
    Own own;
    const bool split = canSplit(key, begin, end, side);
    const bool tooMany = end - begin > std::max(frame_.info.nodePoints, SliceBuilder::kMostSlicePoints);
    if (!split && tooMany) begin = takeSlices(key, side, begin, end, own);
    own.levels = sampleNode(frame_.sampling, localPoints(side, begin, end),
                            split ? frame_.info.nodePoints : LevelOrder::kAll, scratch_);
    own.records.resize(own.levels.order.size());
    for (std::size_t i = 0; i < own.records.size(); ++i)
      own.records[i] = columns_[side].record[begin + own.levels.order[i]];
    if (split && frame_.averages())
      own.represented = averaged(representedBy(scratch_, end - begin, own.levels.order), own.records.size(),
                                 [&](std::size_t i) { return representedAt(columns_[side].record[begin + i]); });
    own.octants.fill(begin);
    if (split) moveRest(side, begin, end, childBit(key), own);
    return own;
  }

  /// Makes slices of what is too many for a cell that cannot be divided; returns where the node's own points begin.
  std::size_t takeSlices(NodeKey key, int side, std::size_t begin, std::size_t end, Own& own) {
    constexpr std::size_t kMost = SliceBuilder::kMostSlicePoints;
    const std::size_t stride = frame_.format.stride();
    SliceBuilder builder(frame_, key, end - begin);
    std::vector<std::byte> packed(kMost * stride);
    for (; end - begin > kMost; begin += kMost) {
      for (std::size_t i = 0; i < kMost; ++i)
        std::memcpy(packed.data() + i * stride, records_.data() + columns_[side].record[begin + i] * stride, stride);
      for (BuiltNode& slice : builder.add(packed)) own.slices.push_back(std::move(slice));
    }
    own.sliceShape = builder.takeTopChildren();
    return begin;
  }

  void moveRest(int side, std::size_t begin, std::size_t end, int bit, Own& own) {
    const Columns& from = columns_[side];
    Columns& to = columns_[1 - side];
    std::fill(taken_.begin() + static_cast<std::ptrdiff_t>(begin), taken_.begin() + static_cast<std::ptrdiff_t>(end),
              std::uint8_t{0});
    for (const std::uint32_t i : own.levels.order) taken_[begin + i] = 1;
    std::array<std::size_t, 8> counts{};
    for (std::size_t i = begin; i < end; ++i)
      counts[static_cast<std::size_t>(octantOf(from, i, bit))] += 1u - taken_[i];
    for (std::size_t o = 0; o < 8; ++o) own.octants[o + 1] = own.octants[o] + counts[o];
    std::array<std::size_t, 9> next = own.octants;
    for (std::size_t i = begin; i < end; ++i) {
      if (taken_[i]) continue;
      const std::size_t at = next[static_cast<std::size_t>(octantOf(from, i, bit))]++;
      for (std::size_t axis = 0; axis < 3; ++axis) to.axis[axis][at] = from.axis[axis][i];
      to.record[at] = from.record[i];
    }
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
    const std::size_t place = nodes.size();
    nodes.emplace_back();
    Own own = takeOwn(key, side, begin, end);
    const std::vector<SubtreeShape> children = buildChildren(key, side, own, nodes);
    NodePoints points = gather(frame_, records_, frame_.format.stride(), own.records);
    for (const Represented& one : own.represented) points.drawColours.push_back(one.colour);
    Moments moments = cellFrame_.world(own.levels.moments);
    for (const SubtreeShape& slice : own.sliceShape) moments.add(slice.moments);
    FinishedNode finished = finishNode(frame_, key, std::move(points), own.levels, moments, children);
    nodes[place] = std::move(finished.node);
    return finished.shape;
  }

  const BuildFrame& frame_;
  const NodeKey cell_;
  const CellFrame cellFrame_;
  const DrawColour colour_;
  const std::vector<std::byte> records_;
  Columns columns_[2];               ///< used in turn by level
  std::vector<std::uint8_t> taken_;  ///< in the range that is being divided: stays in the node
  TreeScratch scratch_;
};

}  // namespace

std::size_t topPointStride(const BuildFrame& frame) {
  return frame.format.stride() + (frame.averages() ? sizeof(Represented) : 0);
}

BuiltChunk buildChunk(const BuildFrame& frame, NodeKey cell, std::vector<std::byte> points) {
  return ChunkBuilder(frame, cell, std::move(points)).build();
}

}  // namespace strata
