#include "converter/build/node_sink.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "io/file/checksum.h"
#include "io/store/store_files.h"

namespace strata {
namespace {

constexpr std::size_t kBufferBytes = std::size_t{8} << 20;

/// The depth in the tree. A slice lies a level below the slice or node that it continues.
int depthOf(const WrittenNode& node) { return NodeKey{node.record.key}.level() + static_cast<int>(node.slice); }

/// Breadth first: by depth, then by the cell's lower corner in Morton order, which cells of one depth never share.
bool comesBefore(const WrittenNode& a, const WrittenNode& b) {
  const int depthA = depthOf(a), depthB = depthOf(b);
  if (depthA != depthB) return depthA < depthB;
  const auto corner = [](const WrittenNode& node) {
    const int level = NodeKey{node.record.key}.level();
    return (node.record.key ^ std::uint64_t{1} << (3 * level)) << (3 * (NodeKey::kDeepestLevel - level));
  };
  return corner(a) < corner(b);
}

/// Puts the nodes in breadth-first order, in which the children of a node are neighbours and come in the order of their
/// parents, and links them.
Hierarchy linkBreadthFirst(std::vector<WrittenNode> nodes) {
  std::sort(nodes.begin(), nodes.end(), comesBefore);
  std::size_t parent = 0;
  for (std::size_t i = 1; i < nodes.size(); ++i) {
    const bool isSlice = nodes[i].slice > 0;
    const std::uint64_t parentKey = isSlice ? nodes[i].record.key : nodes[i].record.key >> 3;
    const std::uint32_t parentSlice = isSlice ? nodes[i].slice - 1 : 0;
    while (nodes[parent].record.key != parentKey || nodes[parent].slice != parentSlice) ++parent;
    NodeRecord& record = nodes[parent].record;
    if (record.childMask == 0) record.firstChild = static_cast<std::uint32_t>(i);
    const auto octant = static_cast<unsigned>(isSlice ? 0 : nodes[i].record.key & 7);
    record.childMask = static_cast<std::uint8_t>(record.childMask | 1u << octant);
    record.sliced = isSlice ? 1 : 0;
  }
  Hierarchy hierarchy;
  hierarchy.nodes.reserve(nodes.size());
  for (const WrittenNode& node : nodes) hierarchy.nodes.push_back(node.record);
  return hierarchy;
}

/// As WrittenChunk::checksum, of the payloads in the file.
std::uint64_t checksumOf(const OutputFile& file, const std::vector<WrittenNode>& nodes) {
  std::vector<std::byte> payload;
  std::uint64_t sum = 0;
  for (const WrittenNode& node : nodes) {
    payload.resize(node.record.payloadBytes);
    file.readAt(node.record.offset, payload);
    sum = checksum(payload, sum);
  }
  return sum;
}

/// Counts the chunks that are in points.bin as they were written, up to the first that is not.
std::size_t soundChunks(const std::string& path, std::span<const WrittenChunk> chunks) {
  std::error_code failure;
  const std::uint64_t bytes = std::filesystem::file_size(path, failure);
  if (failure || chunks.empty()) return 0;
  const OutputFile file(path, std::min(chunks.back().end, bytes));
  std::size_t sound = 0;
  while (sound < chunks.size() && chunks[sound].end <= file.size() &&
         checksumOf(file, chunks[sound].nodes) == chunks[sound].checksum)
    ++sound;
  return sound;
}

}  // namespace

NodeSink::NodeSink(const std::string& folder, std::span<const WrittenChunk> chunks)
    : chunksFound_(soundChunks(folder + "/" + kPointsFile, chunks)) {
  if (chunksFound_ > 0) {
    file_ = std::make_unique<OutputFile>(folder + "/" + kPointsFile, chunks[chunksFound_ - 1].end);
  } else {
    file_ = std::make_unique<OutputFile>(folder + "/" + kPointsFile);
    const PointsHeader header = pointsHeader();
    file_->append(std::as_bytes(std::span(&header, 1)));
  }
  for (const WrittenChunk& chunk : chunks.first(chunksFound_))
    nodes_.insert(nodes_.end(), chunk.nodes.begin(), chunk.nodes.end());
  chunkBegin_ = nodes_.size();
}

void NodeSink::flush() {
  file_->append(buffer_);
  buffer_.clear();
}

void NodeSink::write(std::vector<BuiltNode> nodes) {
  for (BuiltNode& built : nodes) {
    built.node.record.offset = bytes();
    chunkChecksum_ = checksum(built.payload, chunkChecksum_);
    buffer_.insert(buffer_.end(), built.payload.begin(), built.payload.end());
    nodes_.push_back(built.node);
    if (buffer_.size() >= kBufferBytes) flush();
  }
}

WrittenChunk NodeSink::endChunk() {
  flush();
  WrittenChunk out;
  out.end = bytes();
  out.checksum = std::exchange(chunkChecksum_, 0);
  out.nodes.assign(nodes_.begin() + static_cast<std::ptrdiff_t>(chunkBegin_), nodes_.end());
  chunkBegin_ = nodes_.size();
  return out;
}

Hierarchy NodeSink::finish() {
  flush();
  file_->finish();
  return linkBreadthFirst(std::move(nodes_));
}

}  // namespace strata
