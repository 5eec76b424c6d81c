#pragma once
#include <bit>
#include <cstdint>
#include <vector>

namespace strata {

enum class ContourClass : std::uint8_t { volumetric = 0, planar = 1, linear = 2 };

/// One record of hierarchy.bin, byte for byte as on disk: little-endian, 184 bytes (Kanzok 2015, Table 1).
/// Records are in breadth-first order, and the children of a node are neighbours, sorted by octant.
#pragma pack(push, 1)
struct NodeRecord {
  static constexpr int kMaxPrefixes = 16;

  std::uint64_t key;                   ///< NodeKey::code
  std::uint32_t firstChild;            ///< index of the first child's record; 0 = none
  std::uint8_t childMask;              ///< bit i: octant i has a child
  std::uint8_t contourClass;           ///< ContourClass
  std::uint8_t prefixes;               ///< used entries of `prefix`
  std::uint8_t sliced;                 ///< 1: the only child is a slice, which holds more points of the same cell
  std::uint32_t pointCount;            ///< points of this node itself
  float spacing;                       ///< metres between neighbouring points when the whole node is drawn
  double centre[3];                    ///< of the contour, world
  float halfAxis[3][3];                ///< three half-axes of the contour, orthogonal, world metres
  std::uint32_t prefix[kMaxPrefixes];  ///< points of levels 0 to i of the level order; the last used one = pointCount
  std::uint32_t headBytes;             ///< size of the payload's head with its directory of planes
  std::uint64_t offset;                ///< of the payload in points.bin
  std::uint64_t headChecksum;          ///< XXH3-64 of the head
  std::uint32_t payloadBytes;          ///< head and all planes
  std::uint32_t drawBytes[3];          ///< leading payload bytes with all that drawing needs at 10, 20 and 30 bits
};
#pragma pack(pop)
static_assert(sizeof(NodeRecord) == 184);

/// The octree of a store, all of it in memory. Index 0 is the root.
struct Hierarchy {
  std::vector<NodeRecord> nodes;
};

/// The octant of the k-th child (from 0) in a child mask. Its record has the index firstChild + k.
constexpr int childOctant(std::uint8_t childMask, int k) {
  unsigned mask = childMask;
  for (; k > 0; --k) mask &= mask - 1;
  return std::countr_zero(mask);
}

}  // namespace strata
