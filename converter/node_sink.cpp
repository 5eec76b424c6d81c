#include "converter/node_sink.h"

#include <algorithm>
#include <span>

#include "io/store_files.h"

namespace strata {
namespace {

constexpr std::size_t kBufferBytes = std::size_t{8} << 20;

/// Keys with their leading 1 sort by level, then in Morton order: breadth first. Children of a node are neighbours.
Hierarchy linkBreadthFirst(std::vector<NodeRecord> records) {
  std::sort(records.begin(), records.end(), [](const NodeRecord& a, const NodeRecord& b) { return a.key < b.key; });
  std::size_t parent = 0;
  for (std::size_t i = 1; i < records.size(); ++i) {
    const std::uint64_t parentKey = records[i].key >> 3;
    while (records[parent].key != parentKey) ++parent;
    if (records[parent].childMask == 0) records[parent].firstChild = static_cast<std::uint32_t>(i);
    records[parent].childMask = static_cast<std::uint8_t>(records[parent].childMask | 1u << (records[i].key & 7));
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
