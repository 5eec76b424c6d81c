#include "lod/node_decoder.h"

#include <algorithm>

#include "core/point_layout.h"
#include "lod/occluders.h"

namespace strata {
namespace {

/// The most bytes that are kept of a plane that has not been read whole. A request whose end is a guess, because the
/// record does not tell where planes end, brings about so many bytes too many.
std::uint64_t mostKept(const NodeRecord& record) { return record.headBytes + record.payloadBytes / 20; }

/// Gives back the memory that the buffer still holds from a larger node.
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

/// Starts a node with the head of its payload and nothing else.
void startNode(const NodeRecord& record, std::span<const std::byte> bytes, StreamedNode& out) {
  const auto head = bytes.first(std::min<std::size_t>(bytes.size(), record.headBytes));
  out.head.assign(head.begin(), head.end());
  out.occluding.occluders.clear();
  out.occluding.cellSide = 0.0;
}

/// Keeps the bytes behind the last whole plane in `out.head`, so that they need not be read again. More than mostKept()
/// is not worth its memory.
void keepRest(const NodeRecord& record, const LoadRequest& request, std::span<const std::byte> rest,
              StreamedNode& out) {
  out.head.resize(record.headBytes);
  if (rest.size() <= mostKept(record)) {
    out.leadingBytes = request.from + request.bytes;
    out.head.insert(out.head.end(), rest.begin(), rest.end());
  } else {
    out.leadingBytes = out.ends.whole;
  }
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
  // Batches may be shorter than they could be, so twice as many are allowed for, and a few for vectors that grow.
  const std::uint64_t batches = 8 + 2 * ((points + Batch::kMaxPoints - 1) / Batch::kMaxPoints);
  return sizeof(StreamedNode) + record.headBytes + mostKept(record) + batches * sizeof(Batch) + points * bytesAPoint +
         OccluderSet::mostOf(points) * sizeof(Occluder);
}

std::uint64_t nodeBytesBound(const NodeRecord& record, const StoreInfo& info) {
  return nodeBytesBound(record, bytesAPointBound(info));
}

/// Copies the node as it has been to `out`, and joins the old and new bytes that follow its last whole plane.
std::span<const std::byte> NodeDecoder::continueFrom(const StreamedNode& before, const NodeRecord& record,
                                                     std::span<const std::byte> bytes, StreamedNode& out) {
  static_cast<NodeData&>(out) = before;
  out.head = before.head;
  out.occluding = before.occluding;
  joined_.assign(before.head.begin() + record.headBytes, before.head.end());
  joined_.insert(joined_.end(), bytes.begin(), bytes.end());
  return joined_;
}

DecodeResult NodeDecoder::decode(const LoadRequest& request, std::span<const std::byte> bytes,
                                 const StreamedNode* before, bool withOccluders, StreamedNode& out) {
  const NodeRecord& record = store_->hierarchy().nodes[request.node];
  std::uint32_t from = 0;  // where `bytes` begins in the payload
  if (before != nullptr) {
    bytes = continueFrom(*before, record, bytes, out);
    from = before->ends.whole;
  } else {
    startNode(record, bytes, out);
  }
  out.ends = decodeForDrawing(record, store_->info(), {out.head, from, bytes}, scratch_, out);
  if (out.position[0].empty() && record.pointCount > 0) return DecodeResult::tooFewBytes;
  keepRest(record, request, bytes.subspan(out.ends.whole - from), out);
  if (withOccluders && out.occluding.cellSide == 0.0)  // they come from the leading bits alone: once is enough
    findOccluders(out, nodeCube({record.key}, store_->info().rootCube()), record.childMask, out.occluding);
  if (out.memoryBytes() > nodeBytesBound(record, store_->info())) shrink(out);
  return DecodeResult::decoded;
}

}  // namespace strata
