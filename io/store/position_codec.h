#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "io/store/node_payload.h"

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

/// The bit fields of points of one level or plane, least significant bit first, x before y before z; and what of them
/// becomes the points' lanes: of each axis the leading bits, ten at most.
class LaneFields {
 public:
  /// Fields so wide; an axis' bits start `left` above the lane's lowest bit.
  LaneFields() = default;
  LaneFields(const FieldWidths& widths, const int (&left)[3]);

  int bitsAPoint() const { return stride_; }
  /// Lanes of the points from `first` on. There are kBitSlack readable bytes behind the last field.
  void read(const std::byte* fields, std::size_t first, std::span<Lanes> out) const;

 private:
  struct Axis {
    int right = 0, left = 0;  ///< of the lowest bit taken, in the point's fields and in its lanes
    std::uint32_t mask = 0;
  };
  template <class Place>
  void readEach(const std::byte* fields, std::size_t first, std::span<Lanes> out, Place&& place) const;
  void readByDeposit(const std::byte* fields, std::size_t first, std::span<Lanes> out) const;

  Axis axis_[3];
  int stride_ = 0;
  Lanes places_ = 0;       ///< all bits of lanes that fields go to
  bool allTaken_ = false;  ///< no axis has more bits than go to its lane
};

/// Plane 1 or 2 as lanes: fields aligned to the top of 10 bits.
LaneFields planeFields(const PayloadHead& head, int plane);

/// Gives back plane 0 of points in stored order: fields aligned to the top of 10 bits.
class OctreeDecoder {
 public:
  /// False when the bytes do not fit. `stored` has kBitSlack readable bytes behind its end; what is given has to stay
  /// until all has been read.
  bool open(const PayloadHead& head, std::span<const std::uint32_t> levelEnds, std::span<const std::byte> stored);
  /// The next points, which are of one level, the first of them the node's point `first`. False as above.
  bool read(std::size_t first, std::span<Lanes> out);
  /// Nothing is left, as it has to be after the last point.
  bool atEnd() const { return level_ == levelEnds_.size() && occupancy_.empty() && rest_.empty(); }

 private:
  bool openLevel(std::size_t first);
  bool expandCells(int depth, std::size_t most);

  PayloadHead head_{};
  std::span<const std::uint32_t> levelEnds_;
  std::span<const std::byte> depths_, rest_;
  std::vector<std::uint8_t> columns_;  ///< of occupancy, then of flags
  std::span<const std::uint8_t> occupancy_;
  const std::uint8_t* flags_ = nullptr;
  std::size_t level_ = 0, levelFirst_ = 0, levelEnd_ = 0;  ///< the next level; points of the one before it
  LaneFields fields_;
  const std::byte* levelFields_ = nullptr;
  std::vector<Lanes> cells_, spare_;
  std::size_t cell_ = 0;  ///< of the point before, counted from 1
};

}  // namespace strata
