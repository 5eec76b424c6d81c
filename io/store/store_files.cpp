#include "io/store/store_files.h"

#include <cstddef>
#include <cstring>
#include <span>

#include "io/file/checksum.h"
#include "io/file/output_file.h"

namespace strata {

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

}  // namespace strata
