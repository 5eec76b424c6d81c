#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "io/node_payload.h"

namespace strata {

/// The leading 10 bits an axis of points in Morton order, level by level. Sorted points need not say where they are,
/// only which cells of an octree are occupied: down to a depth where about a third as many cells as points are, every
/// cell is one byte (bit i: child octant i = x*4 + y*2 + z has points), breadth first. Then each point has one bit (it
/// is in the next cell) and its remaining bits as fields. See docs/decisions/0007-positions-as-octrees.md.
///
/// Stored: u8 depth of every level; u32 number of occupancy bytes; their column; the column of the one-bit flags, 8
/// points a byte, least significant first; bit fields of every level, each padded to a whole byte.

/// Where the points of one node stand. Ten bits of each axis, 1 << 20 etc. apart: x | y << 10 | z << 20.
using Lanes = std::uint32_t;

/// Morton key of the 10 octree levels of a point, offsets from the head's minimum.
std::uint32_t octreeKey(const PayloadHead& head, const std::uint64_t (&offset)[3]);

/// Bits of an axis that an octree of this depth has told.
int octreeBits(const PayloadHead& head, int axis, int depth);

/// Depth, occupancy and flags of the levels of a node; reused from node to node.
class OctreeEncoder {
 public:
  void clear();
  /// `keys` ascending, of one level. Returns the depth chosen.
  int addLevel(const PayloadHead& head, std::span<const std::uint32_t> keys);
  /// All that stands before the bit fields.
  void append(std::vector<std::byte>& out);

 private:
  void describe(std::span<const std::uint32_t> keys, int depth);

  std::vector<std::uint8_t> depths_;
  std::vector<std::uint8_t> occupancy_;
  std::vector<std::uint8_t> flags_;
  std::uint64_t points_ = 0;
  std::vector<std::uint32_t> cells_;
  std::vector<std::uint8_t> reversed_;
};

/// Decodes plane 0 of points in stored order: fields aligned to the top of 10 bits. `stored` has kBitSlack readable
/// bytes behind its end. False when the bytes do not fit.
bool decodeOctree(const PayloadHead& head, std::span<const std::uint32_t> levelEnds, std::span<const std::byte> stored,
                  std::span<Lanes> out);

/// The same of a plane of bit fields.
bool decodePacked(const PayloadHead& head, std::span<const std::byte> stored, std::span<Lanes> out);

}  // namespace strata
