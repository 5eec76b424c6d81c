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
void shrink(NodeData& node) {
  node.batches.shrink_to_fit();
  for (auto& plane : node.position) plane.shrink_to_fit();
  node.colour.shrink_to_fit();
  node.intensity.shrink_to_fit();
  node.classification.shrink_to_fit();
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
  return sizeof(NodeData) + batches * sizeof(Batch) + points * bytesAPoint(info);
}

bool NodeLoader::load(std::uint32_t node, Precision precision, std::stop_token stop, NodeData& out) {
  const NodeRecord& record = store_.hierarchy().nodes[node];
  payload_.resize(drawBytes(record, precision));
  const std::span<std::byte> bytes(payload_);
  for (std::size_t done = 0; done < bytes.size();) {
    if (stop.stop_requested()) return false;
    const std::size_t part = std::min(kMaxReadBytes, bytes.size() - done);
    store_.points().read(record.offset + done, bytes.subspan(done, part));
    done += part;
  }
  decodeForDrawing(record, store_.info(), bytes, precision, out);
  if (out.bytes() > nodeBytesBound(record, store_.info())) shrink(out);
  return true;
}

}  // namespace strata
