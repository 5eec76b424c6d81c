#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "io/store/store.h"

namespace strata {

/// The on-disk parts of a node's payload (docs/format.md, "Payload"). Shared by the encoder and the decoder.

#pragma pack(push, 1)
/// Followed by u32[levelCount], the points up to and including each level, then by the directory of planes.
struct PayloadHead {
  std::uint32_t pointCount;
  std::uint16_t levelCount;  ///< 0: stored in drawing order
  std::uint16_t planeCount;
  std::int64_t min[3];    ///< grid integers
  std::uint8_t bits[3];   ///< of (grid - min), 0 to 52 an axis
  std::uint8_t start[3];  ///< octree level from which on an axis is halved: long axes first, so that cells are cubes
  std::uint16_t reserved;
};
struct PayloadPlane {
  std::uint16_t id;        ///< PlaneId, or kFirstAttributePlane + index in the layout
  std::uint16_t encoding;  ///< PlaneEncoding
  std::uint32_t storedBytes;
  std::uint64_t checksum;  ///< XXH3-64 of the stored bytes
};
#pragma pack(pop)
static_assert(sizeof(PayloadHead) == 40 && sizeof(PayloadPlane) == 16);

/// Only this many bits of a coordinate can be packed; a store's grid never needs more (cubeBits <= 52).
inline constexpr int kMaxCoordinateBits = 52;
/// Levels of the octree over leading bits; an axis that starts at this one takes no part in it.
inline constexpr int kOctreeLevels = 10;
/// Most points of a node: columns have 24-bit lengths.
inline constexpr std::uint32_t kMaxNodePoints = (1u << 24) - 1;

enum PlaneId : std::uint16_t {
  kPosition10 = 0,      ///< the 10 leading bits an axis
  kPosition20 = 1,      ///< the next 10
  kPosition30 = 2,      ///< all that remain
  kColour = 3,          ///< 8-bit red, green, blue
  kColourResidual = 4,  ///< what the drawn colour leaves of rgb
  kFirstAttributePlane = 16,
};

enum PlaneEncoding : std::uint16_t {
  kConstant = 0,  ///< one element, the same for all points
  kPacked = 1,    ///< bit fields of positions, io/store/bit_packing.h
  kOctree = 2,    ///< leading bits of sorted positions, io/store/position_codec.h
  kColumns = 3,   ///< columns of bytes, io/store/column_codec.h
};

/// Bits of an axis with `bits` that stand in position plane 0, 1 or 2.
inline int planeBits(int bits, int plane) {
  if (plane == 0) return bits < 10 ? bits : 10;
  if (plane == 1) return bits < 10 ? 0 : bits < 20 ? bits - 10 : 10;
  return bits < 20 ? 0 : bits - 20;
}

/// Widths of the three fields of a point in a position plane.
struct FieldWidths {
  int axis[3];
  int sum() const { return axis[0] + axis[1] + axis[2]; }
};
inline FieldWidths planeWidths(const PayloadHead& head, int plane) {
  return {planeBits(head.bits[0], plane), planeBits(head.bits[1], plane), planeBits(head.bits[2], plane)};
}
inline std::size_t packedBytes(std::size_t count, int bitsAPoint) {
  return (count * static_cast<std::size_t>(bitsAPoint) + 7) / 8;
}

}  // namespace strata
