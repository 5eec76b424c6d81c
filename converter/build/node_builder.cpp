#include "converter/build/node_builder.h"

#include <algorithm>

#include "converter/build/contour.h"
#include "converter/memory/copy_bytes.h"

namespace strata {
namespace {

/// Fits box and contour to the points of a node and everything below it.
SubtreeShape fitShape(const BuildContext& context, const NodeParts& parts) {
  const NodePoints& points = parts.points;
  Box box;
  if (points.count() > 0) {
    std::int64_t low[3], high[3];
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = high[axis] = points.grid[axis][0];
      for (const std::int64_t g : points.grid[axis]) {
        low[axis] = std::min(low[axis], g);
        high[axis] = std::max(high[axis], g);
      }
    }
    box.add(context.position(low));
    box.add(context.position(high));
  }
  for (const SubtreeShape& child : parts.children) box.add(child.box);
  return fitContour(parts.moments, box, [&](auto&& see) {
    for (std::size_t i = 0; i < points.count(); ++i)
      see(context.position({points.grid[0][i], points.grid[1][i], points.grid[2][i]}));
    for (const SubtreeShape& child : parts.children)
      for (const glm::dvec3& corner : child.corners()) see(corner);
  });
}

}  // namespace

void appendLocal(const BuildContext& context, const CellCoordinates& cell, std::span<const std::byte> records,
                 std::size_t stride, std::vector<std::int32_t> (&columns)[3]) {
  for (std::size_t at = 0; at < records.size(); at += stride) {
    std::int64_t grid[3];
    context.format.getPosition(records.data() + at, grid);
    for (std::size_t axis = 0; axis < 3; ++axis) columns[axis].push_back(cell.local(grid[axis]));
  }
}

void gather(const BuildContext& context, const std::byte* records, std::size_t stride,
            std::span<const std::uint32_t> which, NodePoints& out) {
  constexpr std::size_t kAhead = 12;  // the records are far apart in memory, so that asking early pays
  const std::size_t attributeBytes = context.format.attributeBytes, positionBytes = context.format.positionBytes();
  for (auto& axis : out.grid) axis.resize(which.size());
  out.attributes.resize(which.size() * attributeBytes);
  out.drawColours.clear();
  std::byte* attributes = out.attributes.data();
  for (std::size_t i = 0; i < which.size(); ++i) {
    if (i + kAhead < which.size()) __builtin_prefetch(records + which[i + kAhead] * stride);
    const std::byte* record = records + which[i] * stride;
    std::int64_t grid[3];
    context.format.getPosition(record, grid);
    for (std::size_t axis = 0; axis < 3; ++axis) out.grid[axis][i] = grid[axis];
    copyBytes(attributes, record + positionBytes, attributeBytes);
    attributes += attributeBytes;
  }
}

FinishedNode finishNode(const BuildContext& context, const NodeParts& parts, EncodeScratch& scratch) {
  const LevelOrder& order = parts.order;
  parts.points.levels = order.prefix;
  EncodedNode encoded = encodeNode(parts.points, context.info, scratch);
  FinishedNode out;
  out.shape = fitShape(context, parts);
  NodeRecord& record = out.node.node.record;
  record.key = parts.key.code;
  record.contourClass = static_cast<std::uint8_t>(out.shape.contourClass);
  record.pointCount = static_cast<std::uint32_t>(parts.points.count());
  record.spacing = static_cast<float>(order.spacing);
  for (int axis = 0; axis < 3; ++axis) {
    record.centre[axis] = out.shape.centre[axis];
    for (std::size_t h = 0; h < 3; ++h) record.halfAxis[h][axis] = static_cast<float>(out.shape.halfAxes[h][axis]);
  }
  record.prefixes = static_cast<std::uint8_t>(order.prefix.size());
  std::copy(order.prefix.begin(), order.prefix.end(), record.prefix);
  record.headBytes = encoded.headBytes;
  record.headChecksum = encoded.headChecksum;
  record.payloadBytes = static_cast<std::uint32_t>(encoded.payload.size());
  std::copy(encoded.drawBytes, encoded.drawBytes + 3, record.drawBytes);
  out.node.payload = std::move(encoded.payload);
  return out;
}

}  // namespace strata
