#include "lod/node_loader.h"

#include <algorithm>
#include <span>

#include "core/point_layout.h"
#include "io/store/node_codec.h"

namespace strata {
namespace {

/// Bytes that are kept of a plane of which not all has been read: what is asked for too much when it is not known where
/// planes end.
std::uint64_t mostKept(const NodeRecord& record) { return record.headBytes + record.payloadBytes / 20; }

/// Gives back what a buffer holds from a larger node before.
void shrink(StreamedNode& node) {
  node.batches.shrink_to_fit();
  for (auto& plane : node.position) plane.shrink_to_fit();
  node.colour.shrink_to_fit();
  node.intensity.shrink_to_fit();
  node.classification.shrink_to_fit();
  node.returnNumber.shrink_to_fit();
  node.normal.shrink_to_fit();
  node.head.shrink_to_fit();
  node.occluding.occluders.shrink_to_fit();
}

}  // namespace

Precision usefulPrecision(const NodeRecord& record, Precision wanted) {
  int planes = static_cast<int>(wanted);
  while (planes > 1 && record.drawBytes[planes - 1] == record.drawBytes[planes - 2]) --planes;
  return static_cast<Precision>(planes);
}

std::uint64_t bytesAPointBound(const StoreInfo& info) {
  std::uint64_t bytes = sizeof(NodeData::position[0][0]) * 3;
  if (info.layout.find(attribute::kRgb) >= 0) bytes += sizeof(std::uint32_t);
  if (info.layout.find(attribute::kIntensity) >= 0) bytes += sizeof(std::uint16_t);
  if (info.layout.find(attribute::kClassification) >= 0) bytes += sizeof(std::uint8_t);
  if (info.layout.find(attribute::kReturnNumber) >= 0) bytes += sizeof(std::uint8_t);
  if (info.layout.find(attribute::kNormal) >= 0 || info.layout.find(attribute::kNormalOctahedral) >= 0)
    bytes += sizeof(std::uint32_t);
  return bytes;
}

std::uint64_t nodeBytesBound(const NodeRecord& record, std::uint64_t bytesAPoint) {
  const std::uint64_t points = record.pointCount;
  // Batches may be shorter than they could be; twice as many are allowed for, and a few for vectors that grow.
  const std::uint64_t batches = 8 + 2 * ((points + Batch::kMaxPoints - 1) / Batch::kMaxPoints);
  return sizeof(StreamedNode) + record.headBytes + mostKept(record) + batches * sizeof(Batch) + points * bytesAPoint +
         OccluderSet::mostOf(points) * sizeof(Occluder);
}

std::uint64_t nodeBytesBound(const NodeRecord& record, const StoreInfo& info) {
  return nodeBytesBound(record, bytesAPointBound(info));
}

std::uint64_t NodeLoader::read(std::span<const LoadRequest> requests, std::stop_token stop) {
  offset_ = requests.front().offset;
  const std::uint64_t size = requests.back().offset + requests.back().bytes - offset_;
  bytes_ = reader_.read(offset_, static_cast<std::size_t>(size), stop);
  return bytes_.size();
}

bool NodeLoader::decode(const LoadRequest& request, const StreamedNode* before, bool withOccluders, StreamedNode& out) {
  const NodeRecord& record = store_->hierarchy().nodes[request.node];
  std::span<const std::byte> bytes = bytes_.subspan(static_cast<std::size_t>(request.offset - offset_), request.bytes);
  std::vector<std::byte> joined;  // with the part of a plane that the read before has brought
  std::uint32_t from = 0;
  if (before != nullptr) {
    static_cast<NodeData&>(out) = *before;
    out.head = before->head;
    out.occluding = before->occluding;
    from = before->ends.whole;
    joined.assign(before->head.begin() + record.headBytes, before->head.end());
    joined.insert(joined.end(), bytes.begin(), bytes.end());
    bytes = joined;
  } else {
    const auto head = bytes.first(std::min<std::size_t>(bytes.size(), record.headBytes));
    out.head.assign(head.begin(), head.end());
    out.occluding.occluders.clear();
    out.occluding.cellSide = 0.0;
  }
  out.ends = decodeForDrawing(record, store_->info(), out.head, from, bytes, scratch_, out);
  if (out.position[0].empty() && record.pointCount > 0) return false;
  // What is left of the bytes is kept behind the head, where it is little.
  const std::span<const std::byte> rest = bytes.subspan(out.ends.whole - from);
  const bool isLittle = rest.size() <= mostKept(record);
  out.leadingBytes = isLittle ? request.from + request.bytes : out.ends.whole;
  out.head.resize(record.headBytes);
  if (isLittle) out.head.insert(out.head.end(), rest.begin(), rest.end());
  if (withOccluders && out.occluding.cellSide == 0.0)  // they come from the leading bits alone: once is enough
    findOccluders(out, nodeCube({record.key}, store_->info().rootCube()), record.childMask, out.occluding);
  if (out.memoryBytes() > nodeBytesBound(record, store_->info())) shrink(out);
  return true;
}

}  // namespace strata
