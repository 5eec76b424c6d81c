#include "converter/build/slices.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "converter/build/lod_colour.h"

namespace strata {

SliceBuilder::SliceBuilder(const BuildContext& context, NodeKey cell, std::uint64_t points)
    : context_(context), cell_(cell), slicesLeft_(points == 0 ? 0 : (points - 1) / kMostSlicePoints) {}

std::vector<BuiltNode> SliceBuilder::add(std::span<const std::byte> packed) {
  std::vector<BuiltNode> full;
  const std::size_t sliceBytes = kMostSlicePoints * context_.format.stride();
  while (!packed.empty()) {
    const std::size_t taken = slicesLeft_ > 0 ? std::min(packed.size(), sliceBytes - pending_.size()) : packed.size();
    pending_.insert(pending_.end(), packed.begin(), packed.begin() + static_cast<std::ptrdiff_t>(taken));
    packed = packed.subspan(taken);
    if (slicesLeft_ == 0 || pending_.size() < sliceBytes) continue;
    full.push_back(finishSlice(pending_));
    pending_.clear();
  }
  return full;
}

std::vector<std::byte> SliceBuilder::takeTopPoints() {
  if (!context_.averages()) return std::move(pending_);
  const DrawColour colour(context_.info);
  const std::size_t stride = context_.format.stride(), topStride = context_.topPointStride();
  std::vector<std::byte> packed(pending_.size() / stride * topStride);
  for (std::size_t i = 0; i < pending_.size() / stride; ++i) {
    const std::byte* record = pending_.data() + i * stride;
    const Represented itself{colour.of(record + context_.format.positionBytes())};
    std::memcpy(packed.data() + i * topStride, record, stride);
    std::memcpy(packed.data() + i * topStride + stride, &itself, sizeof itself);
  }
  pending_.clear();
  return packed;
}

std::vector<SubtreeShape> SliceBuilder::takeTopChildren() {
  std::vector<SubtreeShape> children;
  if (below_) children.push_back(*below_);
  return children;
}

BuiltNode SliceBuilder::finishSlice(std::span<const std::byte> packed) {
  const CellCoordinates cell(context_, cell_);
  const std::size_t stride = context_.format.stride();
  std::vector<std::int32_t> columns[3];
  appendLocal(context_, cell, packed, stride, columns);
  const LevelOrder order = levelOrder({{columns[0], columns[1], columns[2]}, cell.step}, LevelOrder::kAll, scratch_);
  Moments moments = cell.world(order.moments);
  const std::vector<SubtreeShape> children = takeTopChildren();
  for (const SubtreeShape& child : children) moments.add(child.moments);
  NodePoints points;
  gather(context_, packed.data(), stride, order.order, points);
  FinishedNode finished = finishNode(context_, {cell_, points, order, moments, children}, encodeScratch_);
  finished.node.node.slice = static_cast<std::uint32_t>(slicesLeft_--);
  below_ = finished.shape;
  return std::move(finished.node);
}

}  // namespace strata
