#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/box.h"
#include "core/node_key.h"
#include "core/point_layout.h"
#include "io/file/byte_source.h"
#include "io/store/las_meta.h"

namespace strata {

inline constexpr int kStoreVersion = 2;

/// What an attribute holds in this store, over all points (of the first component's range for vectors: all of them).
struct AttributeRange {
  double min = 0.0;
  double max = 0.0;
  double low = 0.0;   ///< 1st percentile: what drawing takes as black (equal to min where not gathered)
  double high = 0.0;  ///< 99th percentile
};

/// One input of the conversion.
struct StoreSource {
  std::string path;
  std::string format;
  std::uint64_t points = 0;
  std::uint64_t skipped = 0;  ///< points left out: not finite, or lost to damage that the user accepted
};

/// The grid that positions are kept on: world = offset + scale * integer, integers from 0.
struct StoreGrid {
  glm::dvec3 scale{0.001};
  glm::dvec3 offset{0.0};
  bool exact = true;  ///< every source coordinate lies on the grid; else within half a step of it
};

/// store.json, see docs/format.md.
struct StoreInfo {
  int version = kStoreVersion;
  std::string program;  ///< "strata 0.1.0"
  std::uint64_t points = 0;
  std::uint64_t nodes = 0;
  int levels = 0;  ///< depth of the deepest node + 1
  Box bounds;      ///< tight, world
  StoreGrid grid;
  int cubeBits = 0;  ///< the root cube spans 2^cubeBits grid steps along each axis, from integer 0
  std::string crs;
  PointLayout layout;
  std::vector<AttributeRange> ranges;  ///< one for each attribute of the layout
  int colourShift = 0;           ///< drawn colour = rgb >> colourShift: 8, or 0 where the source keeps 0-255 in 16 bits
  std::uint32_t nodePoints = 0;  ///< capacity the conversion aimed at
  std::string sampling;
  std::uint64_t skipped = 0;
  std::vector<StoreSource> sources;
  std::optional<LasMeta> las;  ///< of the first LAS source, for exporting

  Box rootCube() const;
};

enum class ContourClass : std::uint8_t { volumetric = 0, planar = 1, linear = 2 };

/// One record of hierarchy.bin, exactly as on disk (little-endian, 184 bytes; Kanzok 2015, Table 1).
/// Records stand in breadth-first order; the children of a node are neighbours, by ascending octant.
#pragma pack(push, 1)
struct NodeRecord {
  static constexpr int kMaxPrefixes = 16;

  std::uint64_t key;                   ///< NodeKey::code
  std::uint32_t firstChild;            ///< index of the first child's record; 0 = none
  std::uint8_t childMask;              ///< bit i: octant i has a child
  std::uint8_t contourClass;           ///< ContourClass
  std::uint8_t prefixes;               ///< used entries of `prefix`
  std::uint8_t sliced;                 ///< 1: the only child is a slice, more points of the same cell
  std::uint32_t pointCount;            ///< points kept in this node itself
  float spacing;                       ///< metres between neighbouring points when the whole node is drawn
  double centre[3];                    ///< of the contour, world
  float halfAxis[3][3];                ///< three half-axes, orthogonal, world metres
  std::uint32_t prefix[kMaxPrefixes];  ///< points of the levels up to and including i; the last used = pointCount
  std::uint32_t headBytes;             ///< size of the payload's head (batches and plane directory)
  std::uint64_t offset;                ///< of the payload in points.bin
  std::uint64_t headChecksum;          ///< XXH3-64 of the head
  std::uint32_t payloadBytes;          ///< head and all planes
  std::uint32_t drawBytes[3];          ///< leading payload bytes that hold all that drawing needs at 10, 20, 30 bits
};
#pragma pack(pop)
static_assert(sizeof(NodeRecord) == 184);

/// The octree of a store, all of it in memory. Index 0 is the root. Immutable, so free to share between threads.
struct Hierarchy {
  std::vector<NodeRecord> nodes;
};

/// Octant of the k-th (0-based) child in a child mask; children stand at firstChild + k.
int childOctant(std::uint8_t childMask, int k);

/// A converted data set, opened for reading. Immutable after construction; all members may be used by any thread.
class Store {
 public:
  /// `path` is NAME.strata. Throws Error when it is no store, is of a newer version, or its parts do not agree.
  explicit Store(const std::string& path);
  /// The same with another source for points.bin, for tests.
  Store(const std::string& path, std::unique_ptr<ByteSource> points);
  /// From parts that are in memory already; nothing is checked.
  Store(StoreInfo info, Hierarchy hierarchy, std::unique_ptr<ByteSource> points);

  const std::string& path() const { return path_; }
  const StoreInfo& info() const { return info_; }
  const Hierarchy& hierarchy() const { return hierarchy_; }
  const ByteSource& points() const { return *points_; }

 private:
  std::string path_;
  StoreInfo info_;
  Hierarchy hierarchy_;
  std::unique_ptr<ByteSource> points_;
};

/// Text of store.json and back. parseStoreInfo throws Error naming `path` and what is wrong.
std::string storeInfoJson(const StoreInfo& info);
StoreInfo parseStoreInfo(const std::string& path, const std::string& json);

}  // namespace strata
