#include "converter/build/node_sink.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "io/file/checksum.h"
#include "io/store/store_files.h"

namespace strata {
namespace {

constexpr std::size_t kBufferBytes = std::size_t{8} << 20;

/// Number of a record in its chain of slices; 0 for ordinary nodes.
std::uint32_t sliceNumber(const NodeRecord& record) { return record.firstChild; }

/// A slice is a level below what it continues.
int depthOf(const NodeRecord& record) { return NodeKey{record.key}.level() + static_cast<int>(sliceNumber(record)); }

/// Breadth first: by depth, then by the cell's lower corner in Morton order, which cells of one depth never share.
bool standsBefore(const NodeRecord& a, const NodeRecord& b) {
  const int depthA = depthOf(a), depthB = depthOf(b);
  if (depthA != depthB) return depthA < depthB;
  const auto corner = [](const NodeRecord& record) {
    const int level = NodeKey{record.key}.level();
    return (record.key ^ std::uint64_t{1} << (3 * level)) << (3 * (NodeKey::kDeepestLevel - level));
  };
  return corner(a) < corner(b);
}

/// Puts the records in breadth-first order, so that the children of a node are neighbours.
Hierarchy linkBreadthFirst(std::vector<NodeRecord> records) {
  std::sort(records.begin(), records.end(), standsBefore);
  std::vector<std::uint32_t> slices(records.size());
  for (std::size_t i = 0; i < records.size(); ++i) slices[i] = std::exchange(records[i].firstChild, 0);
  std::size_t parent = 0;
  for (std::size_t i = 1; i < records.size(); ++i) {
    const bool slice = slices[i] > 0;
    const std::uint64_t parentKey = slice ? records[i].key : records[i].key >> 3;
    while (records[parent].key != parentKey || slices[parent] != (slice ? slices[i] - 1 : 0)) ++parent;
    if (records[parent].childMask == 0) records[parent].firstChild = static_cast<std::uint32_t>(i);
    const auto octant = static_cast<unsigned>(slice ? 0 : records[i].key & 7);
    records[parent].childMask = static_cast<std::uint8_t>(records[parent].childMask | 1u << octant);
    records[parent].sliced = slice ? 1 : 0;
  }
  return {std::move(records)};
}

/// Node by node: each payload's checksum is the seed of the next.
std::uint64_t checksumOf(const OutputFile& file, const std::vector<NodeRecord>& nodes) {
  std::vector<std::byte> payload;
  std::uint64_t sum = 0;
  for (const NodeRecord& node : nodes) {
    payload.resize(node.payloadBytes);
    file.readAt(node.offset, payload);
    sum = checksum(payload, sum);
  }
  return sum;
}

/// How many of the chunks are in points.bin as they were written.
std::size_t soundChunks(const std::string& path, std::span<const NodeSink::Written> chunks) {
  std::error_code failure;
  const std::uint64_t bytes = std::filesystem::file_size(path, failure);
  if (failure || chunks.empty()) return 0;
  const OutputFile file(path, std::min(chunks.back().end, bytes));
  std::size_t sound = 0;
  while (sound < chunks.size() && chunks[sound].end <= file.size() &&
         checksumOf(file, chunks[sound].records) == chunks[sound].checksum)
    ++sound;
  return sound;
}

}  // namespace

NodeSink::NodeSink(const std::string& folder, std::span<const Written> chunks)
    : chunksFound_(soundChunks(folder + "/" + kPointsFile, chunks)) {
  if (chunksFound_ > 0) {
    file_ = std::make_unique<OutputFile>(folder + "/" + kPointsFile, chunks[chunksFound_ - 1].end);
  } else {
    file_ = std::make_unique<OutputFile>(folder + "/" + kPointsFile);
    const PointsHeader header = pointsHeader();
    file_->append(std::as_bytes(std::span(&header, 1)));
  }
  for (const Written& chunk : chunks.first(chunksFound_))
    records_.insert(records_.end(), chunk.records.begin(), chunk.records.end());
  chunkBegin_ = records_.size();
}

void NodeSink::flush() {
  file_->append(buffer_);
  buffer_.clear();
}

void NodeSink::write(std::vector<BuiltNode> nodes) {
  for (BuiltNode& node : nodes) {
    node.record.offset = bytes();
    chunkChecksum_ = checksum(node.payload, chunkChecksum_);
    buffer_.insert(buffer_.end(), node.payload.begin(), node.payload.end());
    records_.push_back(node.record);
    if (buffer_.size() >= kBufferBytes) flush();
  }
}

NodeSink::Written NodeSink::endChunk() {
  flush();
  Written out;
  out.end = bytes();
  out.checksum = std::exchange(chunkChecksum_, 0);
  out.records.assign(records_.begin() + static_cast<std::ptrdiff_t>(chunkBegin_), records_.end());
  chunkBegin_ = records_.size();
  return out;
}

Hierarchy NodeSink::finish() {
  flush();
  file_->finish();
  return linkBreadthFirst(std::move(records_));
}

}  // namespace strata
