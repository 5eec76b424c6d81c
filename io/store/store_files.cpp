#include "io/store/store_files.h"

#include <bit>
#include <cstddef>
#include <cstring>
#include <memory>
#include <span>

#include "core/error.h"
#include "core/node_key.h"
#include "io/file/checksum.h"
#include "io/file/output_file.h"

namespace strata {
namespace {

void checkVersion(const std::string& path, std::uint64_t found) {
  if (found != kStoreVersion)
    throw Error(path, "store version is not supported, found " + std::to_string(found) + " (expected " +
                          std::to_string(kStoreVersion) + ")");
}

HierarchyHeader readHierarchyHeader(const ByteSource& file) {
  HierarchyHeader header;
  if (file.size() < sizeof header)
    throw Error(file.name(), "file too short, found " + std::to_string(file.size()) + " bytes (expected at least " +
                                 std::to_string(sizeof header) + ")");
  file.read(0, std::as_writable_bytes(std::span(&header, 1)));
  if (std::memcmp(header.magic, kHierarchyMagic, sizeof header.magic) != 0)
    throw Error(file.name(), "is not a Strata hierarchy");
  checkVersion(file.name(), header.version);
  if (header.headerChecksum !=
      checksum(std::as_bytes(std::span(&header, 1)).first(offsetof(HierarchyHeader, headerChecksum))))
    throw Error(file.name(), "header checksum mismatch");
  if (header.recordBytes != sizeof(NodeRecord))
    throw Error(file.name(), "record size, found " + std::to_string(header.recordBytes) + " (expected " +
                                 std::to_string(sizeof(NodeRecord)) + ")");
  if (header.nodeCount > (file.size() - sizeof header) / sizeof(NodeRecord) ||
      file.size() != sizeof header + header.nodeCount * sizeof(NodeRecord))
    throw Error(file.name(), "file size, found " + std::to_string(file.size()) + " (expected " +
                                 std::to_string(header.nodeCount) + " records of 184 bytes behind a header of 64)");
  return header;
}

}  // namespace

PointsHeader pointsHeader() {
  PointsHeader header{};
  std::memcpy(header.magic, kPointsMagic, sizeof header.magic);
  header.version = kStoreVersion;
  return header;
}

void writeStoreFiles(const std::string& folder, const StoreInfo& info, const Hierarchy& hierarchy,
                     std::uint64_t pointsBytes) {
  const std::string json = storeInfoJson(info);
  OutputFile infoFile(folder + "/" + kInfoFile);
  infoFile.append(std::as_bytes(std::span(json)));
  infoFile.finish();

  HierarchyHeader header{};
  std::memcpy(header.magic, kHierarchyMagic, sizeof header.magic);
  header.version = kStoreVersion;
  header.recordBytes = sizeof(NodeRecord);
  header.nodeCount = hierarchy.nodes.size();
  header.pointsBytes = pointsBytes;
  header.recordsChecksum = checksum(std::as_bytes(std::span(hierarchy.nodes)));
  header.infoChecksum = checksum(std::as_bytes(std::span(json)));
  header.headerChecksum =
      checksum(std::as_bytes(std::span(&header, 1)).first(offsetof(HierarchyHeader, headerChecksum)));
  OutputFile records(folder + "/" + kHierarchyFile);
  records.append(std::as_bytes(std::span(&header, 1)));
  records.append(std::as_bytes(std::span(hierarchy.nodes)));
  records.finish();
}

void checkPointsHeader(const ByteSource& points) {
  PointsHeader header;
  if (points.size() < sizeof header) throw Error(points.name(), "file too short");
  points.read(0, std::as_writable_bytes(std::span(&header, 1)));
  if (std::memcmp(header.magic, kPointsMagic, sizeof header.magic) != 0)
    throw Error(points.name(), "is not a Strata points file");
  checkVersion(points.name(), header.version);
  if (header.reserved != 0) throw Error(points.name(), "header is damaged");
}

Hierarchy readHierarchy(const std::string& folder, const StoreInfo& info, const std::string& json,
                        std::uint64_t pointsBytes) {
  const std::unique_ptr<ByteSource> file = openFile(folder + "/" + kHierarchyFile);
  const HierarchyHeader header = readHierarchyHeader(*file);
  if (header.infoChecksum != checksum(std::as_bytes(std::span(json))))
    throw Error(folder + "/" + kInfoFile, "checksum mismatch (changed after the conversion)");
  if (header.pointsBytes != pointsBytes)
    throw Error(folder + "/" + kPointsFile, "file size, found " + std::to_string(pointsBytes) + " (expected " +
                                                std::to_string(header.pointsBytes) + ")");
  Hierarchy hierarchy;
  hierarchy.nodes.resize(header.nodeCount);
  file->read(sizeof header, std::as_writable_bytes(std::span(hierarchy.nodes)));
  if (header.recordsChecksum != checksum(std::as_bytes(std::span(hierarchy.nodes))))
    throw Error(file->name(), "records checksum mismatch");
  if (header.nodeCount != info.nodes)
    throw Error(file->name(), "node count, found " + std::to_string(header.nodeCount) + " (expected " +
                                  std::to_string(info.nodes) + ")");
  checkHierarchy(file->name(), hierarchy, pointsBytes);
  return hierarchy;
}

void checkHierarchy(const std::string& file, const Hierarchy& hierarchy, std::uint64_t pointsBytes) {
  const std::vector<NodeRecord>& nodes = hierarchy.nodes;
  const auto fail = [&](const NodeRecord& n, const char* what) {
    throw Error(file, "node " + NodeKey{n.key}.text() + ": " + what);
  };
  if (nodes.empty() || nodes[0].key != 1) throw Error(file, "has no root node");
  std::uint64_t nextChild = 1;
  for (const NodeRecord& n : nodes) {
    if (n.childMask != 0) {
      if (n.firstChild != nextChild) fail(n, "children are not in breadth-first order");
      const int children = std::popcount(n.childMask);
      if (nextChild + static_cast<std::uint64_t>(children) > nodes.size())
        fail(n, "has a child beyond the last record");
      for (int k = 0; k < children; ++k) {
        const std::uint64_t key = n.sliced == 1 ? n.key : NodeKey{n.key}.child(childOctant(n.childMask, k)).code;
        if (nodes[nextChild + static_cast<std::uint64_t>(k)].key != key) fail(n, "has a child with another key");
      }
      nextChild += static_cast<std::uint64_t>(children);
    }
    if (n.sliced > 1 || (n.sliced == 1 && n.childMask != 1)) fail(n, "has slices that are not its only child");
    if (NodeKey{n.key}.level() > NodeKey::kDeepestLevel) fail(n, "is deeper than level 20");
    if (n.prefixes == 0 || n.prefixes > NodeRecord::kMaxPrefixes || n.prefix[n.prefixes - 1] != n.pointCount)
      fail(n, "prefix counts do not end at the point count");
    if (n.offset < sizeof(PointsHeader) || n.offset > pointsBytes || n.payloadBytes > pointsBytes - n.offset)
      fail(n, "payload lies outside points.bin");
    if (n.headBytes > n.drawBytes[0] || n.drawBytes[0] > n.drawBytes[1] || n.drawBytes[1] > n.drawBytes[2] ||
        n.drawBytes[2] > n.payloadBytes)
      fail(n, "payload parts overlap");
  }
  if (nextChild != nodes.size()) throw Error(file, "has records that no node names as a child");
}

}  // namespace strata
