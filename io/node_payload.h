#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "io/store.h"

namespace strata {

/// The on-disk parts of a node's payload (docs/format.md, "Payload"). Shared by the encoder and the decoder.

#pragma pack(push, 1)
struct PayloadHead {
  std::uint32_t pointCount;
  std::uint16_t batchCount;
  std::uint16_t planeCount;
};
struct PayloadBatch {
  std::int64_t min[3];  ///< grid integers
  std::uint32_t pointCount;
  std::uint8_t bits[3];  ///< of (grid - min), 0 to 63 an axis
  std::uint8_t reserved;
};
struct PayloadPlane {
  std::uint16_t id;        ///< PlaneId, or kFirstAttributePlane + index in the layout
  std::uint16_t encoding;  ///< PlaneEncoding
  std::uint32_t rawBytes;  ///< after decoding
  std::uint32_t storedBytes;
  std::uint32_t reserved;
  std::uint64_t checksum;  ///< XXH3-64 of the stored bytes
};
#pragma pack(pop)
static_assert(sizeof(PayloadHead) == 8 && sizeof(PayloadBatch) == 32 && sizeof(PayloadPlane) == 24);

/// Only this many bits of a coordinate can be packed; a store's grid never needs more (cubeBits <= 52).
inline constexpr int kMaxCoordinateBits = 52;

enum PlaneId : std::uint16_t {
  kPosition10 = 0,      ///< the 10 leading bits an axis
  kPosition20 = 1,      ///< the next 10
  kPosition30 = 2,      ///< all that remain
  kColour = 3,          ///< 8-bit red, green, blue
  kColourResidual = 4,  ///< u16 x 3: rgb - (colour << colourShift)
  kFirstAttributePlane = 16,
};

enum PlaneEncoding : std::uint16_t {
  kConstant = 0,  ///< one element, the same for all points
  kRaw = 1,
  kLz4 = 2,
};

/// Bits of an axis with `bits` that stand in position plane 0, 1 or 2.
inline int planeBits(int bits, int plane) {
  if (plane == 0) return bits < 10 ? bits : 10;
  if (plane == 1) return bits < 10 ? 0 : bits < 20 ? bits - 10 : 10;
  return bits < 20 ? 0 : bits - 20;
}

/// Bytes that a batch takes in a position plane.
inline std::uint64_t packedBytes(const PayloadBatch& batch, int plane) {
  std::uint64_t bits = 0;
  for (const std::uint8_t axisBits : batch.bits) bits += static_cast<std::uint64_t>(planeBits(axisBits, plane));
  return (bits * batch.pointCount + 7) / 8;
}

}  // namespace strata
