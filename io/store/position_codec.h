#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "io/store/node_payload.h"

namespace strata {

/// Plane 0 of a payload: the leading 10 bits of each axis, of points in Morton order, level by level. Points that are
/// sorted need not say where they are; it is enough to say which cells of an octree hold points. Down to a depth with
/// about a third as many cells as points, every cell is one byte, breadth first: bit i tells that its child octant
/// i = x * 4 + y * 2 + z has points. Then each point has one flag, which tells that it is in the next cell, and bit
/// fields with the bits that the octree does not tell. See docs/decisions/0007-positions-as-octrees.md.
///
/// Stored are a u8 depth for every level; a u32, the number of occupancy bytes; the column of these bytes; the column
/// of the flags, 8 points in a byte, least significant first; and the bit fields of every level, padded to a whole
/// byte.

/// Ten bits of each axis of a point: x | y << 10 | z << 20.
using Lanes = std::uint32_t;

/// The Morton key of a point over the 10 levels of the octree, from its offsets from the head's minimum.
std::uint32_t octreeKey(const PayloadHead& head, const std::uint64_t (&offset)[3]);

/// The number of bits of an axis that an octree of this depth tells.
int octreeBits(const PayloadHead& head, int axis, int depth);

/// Collects depth, occupancy and flags of the levels of a node. It can be used again for the next node.
class OctreeEncoder {
 public:
  void clear();
  /// Adds a level, given by its keys in ascending order. Returns the depth chosen for its octree.
  int addLevel(const PayloadHead& head, std::span<const std::uint32_t> keys);
  /// Appends everything that comes before the bit fields.
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

/// How bit fields of points become lanes. The fields of a point are x, y and z, least significant bit first; a lane
/// takes at most ten leading bits of each.
class LaneFields {
 public:
  LaneFields() = default;
  /// `left` is the number of lowest bits of each axis of the lane that the fields leave 0.
  LaneFields(const FieldWidths& widths, const int (&left)[3]);

  int bitsAPoint() const { return stride_; }
  /// Reads the lanes of the points from `first` on. kBitSlack bytes behind the last field must be readable.
  void read(const std::byte* fields, std::size_t first, std::span<Lanes> out) const;

 private:
  struct Axis {
    int right = 0, left = 0;  ///< of the lowest bit taken: its place in the point's fields and in its lanes
    std::uint32_t mask = 0;
  };
  template <class PlaceFields>
  void readEach(const std::byte* fields, std::size_t first, std::span<Lanes> out, PlaceFields&& place) const;
  void readByDeposit(const std::byte* fields, std::size_t first, std::span<Lanes> out) const;

  Axis axis_[3];
  int stride_ = 0;
  Lanes places_ = 0;       ///< all bits of lanes that are taken from fields
  bool allTaken_ = false;  ///< every bit of the fields goes to a lane
};

/// The fields of a packed position plane as lanes, aligned to the top of 10 bits.
LaneFields planeFields(const PayloadHead& head, int plane);

/// Decodes plane 0 into one lane per point, in stored order. Every coordinate has 10 bits; where the plane stores
/// fewer, they are the upper ones.
class OctreeDecoder {
 public:
  /// False when the bytes are no such plane. kBitSlack bytes behind `stored` must be readable, and both spans must stay
  /// valid until the last read().
  bool open(const PayloadHead& head, std::span<const std::uint32_t> levelEnds, std::span<const std::byte> stored);
  /// Reads the next points, which must be of one level; `first` is the index in the node of the first. False as above.
  bool read(std::size_t first, std::span<Lanes> out);
  /// True when no byte is left, as it must be after the last point.
  bool atEnd() const { return level_ == levelEnds_.size() && occupancy_.empty() && rest_.empty(); }

 private:
  bool openLevel(std::size_t first);
  bool expandCells(int depth, std::size_t most);

  PayloadHead head_{};
  std::span<const std::uint32_t> levelEnds_;
  std::span<const std::byte> depths_, rest_;
  std::vector<std::uint8_t> columns_;  ///< occupancy, then flags
  std::span<const std::uint8_t> occupancy_;
  const std::uint8_t* flags_ = nullptr;
  std::size_t level_ = 0, levelFirst_ = 0, levelEnd_ = 0;  ///< the next level; the points of the one before it
  LaneFields fields_;
  const std::byte* levelFields_ = nullptr;
  std::vector<Lanes> cells_, spare_;
  std::size_t cell_ = 0;  ///< cell of the point before, counted from 1
};

}  // namespace strata
