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
  std::vector<std::byte> stored;    ///< a plane that needs kBitSlack bytes behind it
  std::vector<std::uint8_t> spare;  ///< columns
  OctreeDecoder octree;
};

/// The parts of one payload, every length checked against the record and against each other. Everything throws Error
/// (`points.bin: node r042: block checksum mismatch`) for what does not fit.
class PayloadReader {
 public:
  /// `part` is what of the payload is at hand, from `from` on; `head` begins with its head.
  PayloadReader(const NodeRecord& record, std::span<const std::byte> head, std::size_t from,
                std::span<const std::byte> part, DecodeScratch::Buffers& buffers);

  [[noreturn]] void fail(const std::string& what) const;
  const PayloadHead& head() const { return parsed_.head; }
  std::span<const std::uint32_t> levelEnds() const { return parsed_.levelEnds; }
  std::size_t pointCount() const { return record_.pointCount; }
  DecodeScratch::Buffers& buffers() { return buffers_; }

  /// Where the plane ends in the payload; 0 when there is none.
  std::size_t endOf(std::uint16_t id) const;
  /// Where the last plane ends that is at hand whole, and all before it.
  std::size_t wholeEnd() const;
  /// False as well where not all of the plane is at hand, or nothing is stored of it.
  bool holds(std::uint16_t id) const;

  /// The stored bytes of a plane, checked, with kBitSlack readable bytes behind them; valid until the next call.
  struct Plane {
    PlaneEncoding encoding;
    std::span<const std::byte> stored;
  };
  Plane plane(std::uint16_t id);
  /// The checked bit fields of position plane 1 or 2.
  std::span<const std::byte> packedPositions(int plane);

  /// Plane 0, as toDrawingOrder() asks for it: open, then read for all points, then close.
  void openLeading();
  void readLeading(std::size_t first, std::span<Lanes> out);
  void closeLeading() const;

 private:
  const NodeRecord& record_;
  std::span<const std::byte> payload_;
  std::size_t from_;
  ParsedHead parsed_;
  DecodeScratch::Buffers& buffers_;
  bool leadingIsOctree_ = false;
  LaneFields leadingFields_;
  std::span<const std::byte> leading_;
};

/// The values of an attribute's or the residual's next component, in drawing order; moves `rest` on.
template <class T>
void decodeComponent(PayloadReader& payload, const PayloadReader::Plane& plane, std::span<const std::byte>& rest,
                     std::span<T> drawn);

/// All components of an attribute into records from `first` on, `stride` apart, in drawing order.
void decodeAttribute(PayloadReader& payload, int layoutIndex, const Attribute& attribute, std::size_t stride,
                     std::byte* first);

/// What is drawn, 255 in the highest byte.
void decodeDrawnColours(PayloadReader& payload, std::vector<std::uint32_t>& out);

}  // namespace strata
