#include "lod/node_loader.h"

#include <algorithm>
#include <span>

#include "core/point_layout.h"
#include "io/node_codec.h"

namespace strata {
namespace {

std::uint64_t bytesAPoint(const StoreInfo& info) {
  std::uint64_t bytes = sizeof(NodeData::position[0][0]) * 3;
  if (info.layout.find(attribute::kRgb) >= 0) bytes += sizeof(std::uint32_t);
  if (info.layout.find(attribute::kIntensity) >= 0) bytes += sizeof(std::uint16_t);
  if (info.layout.find(attribute::kClassification) >= 0) bytes += sizeof(std::uint8_t);
  return bytes;
}

/// Gives back what a buffer holds from a larger node before.
void shrink(StreamedNode& node) {
  node.batches.shrink_to_fit();
  for (auto& plane : node.position) plane.shrink_to_fit();
  node.colour.shrink_to_fit();
  node.intensity.shrink_to_fit();
  node.classification.shrink_to_fit();
  node.occluding.occluders.shrink_to_fit();
}

}  // namespace

Precision usefulPrecision(const NodeRecord& record, Precision wanted) {
  int planes = static_cast<int>(wanted);
  while (planes > 1 && record.drawBytes[planes - 1] == record.drawBytes[planes - 2]) --planes;
  return static_cast<Precision>(planes);
}

std::uint64_t nodeBytesBound(const NodeRecord& record, const StoreInfo& info) {
  const std::uint64_t points = record.pointCount;
  // Batches may be shorter than they could be; twice as many are allowed for, and a few for vectors that grow.
  const std::uint64_t batches = 8 + 2 * ((points + Batch::kMaxPoints - 1) / Batch::kMaxPoints);
  return sizeof(StreamedNode) + batches * sizeof(Batch) + points * bytesAPoint(info) +
         OccluderSet::mostOf(points) * sizeof(Occluder);
}

std::uint64_t NodeLoader::read(std::span<const LoadRequest> requests, std::stop_token stop) {
  offset_ = requests.front().offset;
  const std::uint64_t size = requests.back().offset + requests.back().bytes - offset_;
  bytes_ = reader_.read(offset_, static_cast<std::size_t>(size), stop);
  return bytes_.size();
}

void NodeLoader::decode(const LoadRequest& request, bool withOccluders, StreamedNode& out) const {
  const NodeRecord& record = store_->hierarchy().nodes[request.node];
  const auto start = static_cast<std::size_t>(request.offset - offset_);
  decodeForDrawing(record, store_->info(), bytes_.subspan(start, request.bytes), request.precision, out);
  if (withOccluders)
    findOccluders(out, nodeCube({record.key}, store_->info().rootCube()), record.childMask, out.occluding);
  else
    out.occluding.occluders.clear();
  if (out.memoryBytes() > nodeBytesBound(record, store_->info())) shrink(out);
}

}  // namespace strata
