#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "io/store/store.h"

namespace strata {

/// The bytes of a node in points.bin are defined here, for the encoder and the decoder, and described in
/// docs/format.md, "Payload".

#pragma pack(push, 1)
/// A payload begins with this head. Then come a u32 for each level, the number of points up to its end, a PayloadPlane
/// for each plane, and the planes.
struct PayloadHead {
  std::uint32_t pointCount;
  std::uint16_t levelCount;  ///< 0 when the points are stored in drawing order
  std::uint16_t planeCount;
  std::int64_t min[3];    ///< grid integers
  std::uint8_t bits[3];   ///< of (grid - min) on each axis, 0 to 52
  std::uint8_t start[3];  ///< octree level from which on each axis is halved: long axes first, so that cells are cubes
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

/// The most bits of a coordinate. A store's grid needs no more, since cubeBits is at most 52.
inline constexpr int kMaxCoordinateBits = 52;
/// Levels of the octree over the leading bits. An axis that starts at this level takes no part in it.
inline constexpr int kOctreeLevels = 10;
/// The most points of a node, since the length of a column has 24 bits.
inline constexpr std::uint32_t kMaxNodePoints = (1u << 24) - 1;

enum PlaneId : std::uint16_t {
  kPosition10 = 0,      ///< the 10 leading bits of each axis
  kPosition20 = 1,      ///< the next 10
  kPosition30 = 2,      ///< all bits that remain
  kColour = 3,          ///< 8-bit red, green, blue
  kColourResidual = 4,  ///< rgb without what the drawn colour tells
  kFirstAttributePlane = 16,
};

enum PlaneEncoding : std::uint16_t {
  kConstant = 0,  ///< one element, equal for all points
  kPacked = 1,    ///< bit fields of positions, io/store/bit_packing.h
  kOctree = 2,    ///< leading bits of sorted positions, io/store/position_codec.h
  kColumns = 3,   ///< columns of bytes, io/store/column_codec.h
};

/// The number of bits in position plane 0, 1 or 2 of an axis that has `bits`.
inline int planeBits(int bits, int plane) {
  if (plane == 0) return bits < 10 ? bits : 10;
  if (plane == 1) return bits < 10 ? 0 : bits < 20 ? bits - 10 : 10;
  return bits < 20 ? 0 : bits - 20;
}

/// Bits of a point on each axis in a position plane.
struct FieldWidths {
  int axis[3];
  int sum() const { return axis[0] + axis[1] + axis[2]; }
};
inline FieldWidths planeWidths(const PayloadHead& head, int plane) {
  return {planeBits(head.bits[0], plane), planeBits(head.bits[1], plane), planeBits(head.bits[2], plane)};
}
/// Bytes of `count` points with `bitsAPoint` bits each.
inline std::size_t packedBytes(std::size_t count, int bitsAPoint) {
  return (count * static_cast<std::size_t>(bitsAPoint) + 7) / 8;
}

}  // namespace strata
