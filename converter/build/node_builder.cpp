#include "converter/build/node_builder.h"

#include <algorithm>

#include "converter/memory/copy_bytes.h"

namespace strata {
namespace {

constexpr int kLocalBits = 31;

/// Box and contour of the points and everything below them.
SubtreeShape fitShape(const BuildFrame& frame, const NodePoints& points, const Moments& moments,
                      std::span<const SubtreeShape> children) {
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
    box.add(frame.position(low));
    box.add(frame.position(high));
  }
  for (const SubtreeShape& child : children) box.add(child.box);
  return fitContour(moments, box, [&](auto&& see) {
    for (std::size_t i = 0; i < points.count(); ++i)
      see(frame.position({points.grid[0][i], points.grid[1][i], points.grid[2][i]}));
    for (const SubtreeShape& child : children)
      for (const glm::dvec3& corner : child.corners()) see(corner);
  });
}

}  // namespace

CellFrame::CellFrame(const BuildFrame& frame, NodeKey cell) {
  const int cellBits = frame.info.cubeBits - cell.level();
  inside = (std::int64_t{1} << cellBits) - 1;
  bits = std::min(cellBits, kLocalBits);
  shift = cellBits - bits;
  corner = nodeCube(cell, frame.info.rootCube()).min;
  step = frame.info.grid.scale * static_cast<double>(std::int64_t{1} << shift);
}

void appendLocal(const BuildFrame& frame, const CellFrame& cell, std::span<const std::byte> records, std::size_t stride,
                 std::vector<std::int32_t> (&columns)[3]) {
  for (std::size_t at = 0; at < records.size(); at += stride) {
    std::int64_t grid[3];
    frame.format.getPosition(records.data() + at, grid);
    for (std::size_t axis = 0; axis < 3; ++axis) columns[axis].push_back(cell.local(grid[axis]));
  }
}

void gather(const BuildFrame& frame, const std::byte* records, std::size_t stride, std::span<const std::uint32_t> which,
            NodePoints& out) {
  constexpr std::size_t kAhead = 12;  // records are far apart
  const std::size_t attributeBytes = frame.format.attributeBytes, positionBytes = frame.format.positionBytes();
  for (auto& axis : out.grid) axis.resize(which.size());
  out.attributes.resize(which.size() * attributeBytes);
  out.drawColours.clear();
  std::byte* attributes = out.attributes.data();
  for (std::size_t i = 0; i < which.size(); ++i) {
    if (i + kAhead < which.size()) __builtin_prefetch(records + which[i + kAhead] * stride);
    const std::byte* record = records + which[i] * stride;
    std::int64_t grid[3];
    frame.format.getPosition(record, grid);
    for (std::size_t axis = 0; axis < 3; ++axis) out.grid[axis][i] = grid[axis];
    copyBytes(attributes, record + positionBytes, attributeBytes);
    attributes += attributeBytes;
  }
}

FinishedNode finishNode(const BuildFrame& frame, NodeKey key, NodePoints& points, const LevelOrder& levels,
                        const Moments& moments, std::span<const SubtreeShape> children, EncodeScratch& scratch) {
  points.levels.clear();
  if (frame.sampling == Sampling::ntree) points.levels = levels.prefix;
  EncodedNode encoded = encodeNode(points, frame.info, scratch);
  FinishedNode out;
  out.shape = fitShape(frame, points, moments, children);
  NodeRecord& record = out.node.record;
  record.key = key.code;
  record.contourClass = static_cast<std::uint8_t>(out.shape.contourClass);
  record.pointCount = static_cast<std::uint32_t>(points.count());
  record.spacing = static_cast<float>(levels.spacing);
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
