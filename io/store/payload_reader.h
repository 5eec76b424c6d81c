#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "io/store/drawing_order.h"
#include "io/store/node_codec.h"
#include "io/store/payload_head.h"
#include "io/store/position_codec.h"

namespace strata {

struct DecodeScratch::Buffers {
  std::vector<std::byte> stored;    ///< copy of a plane that has no kBitSlack bytes behind it
  std::vector<std::uint8_t> spare;  ///< decoded columns
  OctreeDecoder octree;
};

/// Finds and checks the planes of one payload. Every length is checked against the record and against the others, and
/// all members throw Error (`points.bin: node r042: block checksum mismatch`) for bytes that do not fit.
class PayloadReader {
 public:
  /// `record`, the bytes of `part` and `buffers` must outlive the reader.
  PayloadReader(const NodeRecord& record, const PayloadPart& part, DecodeScratch::Buffers& buffers);

  [[noreturn]] void fail(const std::string& what) const;
  const PayloadHead& head() const { return parsed_.head; }
  std::span<const std::uint32_t> levelEnds() const { return parsed_.levelEnds; }
  std::size_t pointCount() const { return record_.pointCount; }
  DecodeScratch::Buffers& buffers() { return buffers_; }

  /// The end of a plane as an offset in the payload; 0 when there is no such plane.
  std::size_t endOf(std::uint16_t id) const;
  /// The end of the last plane that is in memory whole, as are all planes before it.
  std::size_t wholeEnd() const;
  /// True when the plane stores bytes and all of them are in memory.
  bool holds(std::uint16_t id) const;

  /// The checked bytes of a plane, with kBitSlack readable bytes behind them. They are valid until the next call.
  struct Plane {
    PlaneEncoding encoding;
    std::span<const std::byte> stored;
  };
  Plane plane(std::uint16_t id);
  /// The checked bit fields of position plane 0, 1 or 2, which must not be an octree.
  std::span<const std::byte> packedPositions(int plane);

  /// Plane 0 is opened, read front to back as toDrawingOrder() asks for it, and closed.
  void openLeading();
  void readLeading(std::size_t first, std::span<Lanes> out);
  void closeLeading() const;

 private:
  const NodeRecord& record_;
  std::span<const std::byte> payload_;  ///< the part that is in memory
  std::size_t from_;                    ///< its offset in the payload
  ParsedHead parsed_;
  DecodeScratch::Buffers& buffers_;
  bool leadingIsOctree_ = false;
  LaneFields leadingFields_;
  std::span<const std::byte> leading_;
};

/// Decodes the next component of an attribute or of the residual in drawing order, and takes it off the front of
/// `rest`.
template <class T>
void decodeComponent(PayloadReader& payload, const PayloadReader::Plane& plane, std::span<const std::byte>& rest,
                     std::span<T> drawn);

/// Decodes all components of an attribute in drawing order into records, `stride` bytes apart, whose first has the
/// attribute at `first`.
void decodeAttribute(PayloadReader& payload, int layoutIndex, const Attribute& attribute, std::size_t stride,
                     std::byte* first);

/// Decodes the colours that are drawn, in drawing order and with 255 in the highest byte.
void decodeDrawnColours(PayloadReader& payload, std::vector<std::uint32_t>& out);

}  // namespace strata
