#pragma once
#include <cstdint>
#include <string>

#include "io/file/byte_source.h"
#include "io/store/hierarchy.h"
#include "io/store/store_info.h"

namespace strata {

/// The three files of a store, and the headers of the two binary ones, as docs/format.md describes them.
inline constexpr const char* kInfoFile = "store.json";
inline constexpr const char* kHierarchyFile = "hierarchy.bin";
inline constexpr const char* kPointsFile = "points.bin";
inline constexpr char kHierarchyMagic[8] = {'S', 'T', 'R', 'A', 'T', 'A', '-', 'H'};
inline constexpr char kPointsMagic[8] = {'S', 'T', 'R', 'A', 'T', 'A', '-', 'P'};

#pragma pack(push, 1)
struct HierarchyHeader {
  char magic[8];
  std::uint32_t version;
  std::uint32_t recordBytes;
  std::uint64_t nodeCount;
  std::uint64_t pointsBytes;      ///< size of points.bin
  std::uint64_t recordsChecksum;  ///< XXH3-64 of all records
  std::uint64_t infoChecksum;     ///< XXH3-64 of store.json
  std::uint64_t reserved;
  std::uint64_t headerChecksum;  ///< XXH3-64 of the 56 bytes before
};
struct PointsHeader {
  char magic[8];
  std::uint32_t version;
  std::uint32_t reserved;
};
#pragma pack(pop)
static_assert(sizeof(HierarchyHeader) == 64 && sizeof(PointsHeader) == 16);

/// The header at the start of points.bin; the first payload follows it.
PointsHeader pointsHeader();
/// Throws Error unless `points` starts with such a header.
void checkPointsHeader(const ByteSource& points);

/// Writes store.json and hierarchy.bin into `folder` and makes them durable.
void writeStoreFiles(const std::string& folder, const StoreInfo& info, const Hierarchy& hierarchy,
                     std::uint64_t pointsBytes);

/// Reads hierarchy.bin of the store in `folder`. Throws Error when it is damaged or does not belong to `json`, the text
/// of store.json, whose contents are `info`, or to a points.bin of `pointsBytes` bytes.
Hierarchy readHierarchy(const std::string& folder, const StoreInfo& info, const std::string& json,
                        std::uint64_t pointsBytes);

/// Throws Error naming `file` unless the records form one tree in breadth-first order whose payloads lie in points.bin.
void checkHierarchy(const std::string& file, const Hierarchy& hierarchy, std::uint64_t pointsBytes);

}  // namespace strata
