#include "converter/node_sink.h"

#include <algorithm>
#include <span>
#include <utility>

#include "io/store_files.h"

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

}  // namespace

NodeSink::NodeSink(const std::string& folder) : file_(folder + "/" + kPointsFile) {
  const PointsHeader header = pointsHeader();
  file_.append(std::as_bytes(std::span(&header, 1)));
}

void NodeSink::write(std::vector<BuiltNode> nodes) {
  for (BuiltNode& node : nodes) {
    node.record.offset = bytes();
    buffer_.insert(buffer_.end(), node.payload.begin(), node.payload.end());
    records_.push_back(node.record);
    if (buffer_.size() >= kBufferBytes) {
      file_.append(buffer_);
      buffer_.clear();
    }
  }
}

Hierarchy NodeSink::finish() {
  file_.append(buffer_);
  buffer_.clear();
  file_.finish();
  return linkBreadthFirst(std::move(records_));
}

}  // namespace strata
