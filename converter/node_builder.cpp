#include "converter/node_builder.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/morton.h"
#include "io/node_codec.h"

namespace strata {
namespace {

constexpr int kMostKeyLevels = 21;

NodePoints gather(const BuildFrame& frame, std::span<const std::byte> points, const std::vector<std::uint32_t>& order) {
  const std::size_t stride = frame.format.stride();
  const std::size_t attributeBytes = frame.format.attributeBytes;
  NodePoints out;
  for (auto& axis : out.grid) axis.resize(order.size());
  out.attributes.resize(order.size() * attributeBytes);
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::byte* record = points.data() + order[i] * stride;
    std::int64_t grid[3];
    frame.format.getPosition(record, grid);
    for (std::size_t axis = 0; axis < 3; ++axis) out.grid[axis][i] = grid[axis];
    std::copy_n(record + frame.format.positionBytes(), attributeBytes,
                out.attributes.begin() + static_cast<std::ptrdiff_t>(i * attributeBytes));
  }
  return out;
}

SubtreeShape fitShape(const BuildFrame& frame, const NodePoints& points, std::span<const SubtreeShape> children) {
  Moments moments;
  Box box;
  const auto position = [&](std::size_t i) {
    return frame.position({points.grid[0][i], points.grid[1][i], points.grid[2][i]});
  };
  for (std::size_t i = 0; i < points.count(); ++i) {
    const glm::dvec3 p = position(i);
    moments.add(p);
    box.add(p);
  }
  for (const SubtreeShape& child : children) {
    moments.add(child.moments);
    box.add(child.box);
  }
  return fitContour(moments, box, [&](auto&& see) {
    for (std::size_t i = 0; i < points.count(); ++i) see(position(i));
    for (const SubtreeShape& child : children)
      for (const glm::dvec3& corner : child.corners()) see(corner);
  });
}

}  // namespace

int BuildFrame::keyLevels(NodeKey cell) const { return std::min(info.cubeBits - cell.level(), kMostKeyLevels); }

std::uint64_t BuildFrame::key(NodeKey cell, const std::byte* record) const {
  const int cellBits = info.cubeBits - cell.level();
  const int shift = cellBits - keyLevels(cell);
  const std::uint64_t inside = (std::uint64_t{1} << cellBits) - 1;
  std::int64_t grid[3];
  format.getPosition(record, grid);
  return mortonCode((static_cast<std::uint64_t>(grid[0]) & inside) >> shift,
                    (static_cast<std::uint64_t>(grid[1]) & inside) >> shift,
                    (static_cast<std::uint64_t>(grid[2]) & inside) >> shift);
}

FinishedNode finishNode(const BuildFrame& frame, NodeKey key, std::span<const std::byte> points,
                        std::span<const SubtreeShape> children) {
  const std::size_t stride = frame.format.stride();
  std::vector<std::uint64_t> keys(points.size() / stride);
  for (std::size_t i = 0; i < keys.size(); ++i) keys[i] = frame.key(key, points.data() + i * stride);
  const LevelOrder levels = levelOrder({keys, frame.keyLevels(key)});
  const NodePoints ordered = gather(frame, points, levels.order);
  EncodedNode encoded = encodeNode(ordered, frame.info);

  FinishedNode out;
  out.shape = fitShape(frame, ordered, children);
  NodeRecord& record = out.node.record;
  record.key = key.code;
  record.contourClass = static_cast<std::uint8_t>(out.shape.contourClass);
  record.pointCount = static_cast<std::uint32_t>(keys.size());
  const glm::dvec3 side = nodeCube(key, frame.info.rootCube()).size();
  record.spacing = static_cast<float>(levels.spacing * std::max({side.x, side.y, side.z}));
  for (int axis = 0; axis < 3; ++axis) {
    record.centre[axis] = out.shape.centre[axis];
    for (std::size_t h = 0; h < 3; ++h) record.halfAxis[h][axis] = static_cast<float>(out.shape.halfAxes[h][axis]);
  }
  record.prefixes = static_cast<std::uint8_t>(levels.prefix.size());
  std::copy(levels.prefix.begin(), levels.prefix.end(), record.prefix);
  record.headBytes = encoded.headBytes;
  record.headChecksum = encoded.headChecksum;
  record.payloadBytes = static_cast<std::uint32_t>(encoded.payload.size());
  std::copy(encoded.drawBytes, encoded.drawBytes + 3, record.drawBytes);
  out.node.payload = std::move(encoded.payload);
  return out;
}

}  // namespace strata
