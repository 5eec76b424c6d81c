#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/node_data.h"
#include "io/store/store.h"

namespace strata {

/// All that a store keeps of the points of one node. The converter writes it and an export reads it back.
struct NodePoints {
  std::vector<std::int64_t> grid[3];  ///< integers of StoreGrid
  std::vector<std::byte> attributes;  ///< records of StoreInfo::layout
  /// For each level of the level order the number of points up to its end; the last is count(). The codec sorts the
  /// points inside a level, since sorted points take fewer bytes. Empty when the points are to keep their order.
  std::vector<std::uint32_t> levels;
  /// The colours that the points are drawn with, as R | G << 8 | B << 16. Empty when each is drawn with its own.
  std::vector<std::uint32_t> drawColours;

  std::size_t count() const { return grid[0].size(); }
};

/// A node's payload, and the fields of its NodeRecord that describe it. The writer fills in the offset.
struct EncodedNode {
  std::vector<std::byte> payload;
  std::uint32_t headBytes = 0;
  std::uint64_t headChecksum = 0;
  std::uint32_t drawBytes[3] = {0, 0, 0};
};

/// Working memory of encodeNode(), worth keeping from node to node. It serves one thread at a time.
class EncodeScratch {
 public:
  EncodeScratch();
  ~EncodeScratch();
  EncodeScratch(EncodeScratch&&) noexcept;
  struct Buffers;
  Buffers& buffers() { return *buffers_; }

 private:
  std::unique_ptr<Buffers> buffers_;
};

/// Packs points into planes (node_payload.h and docs/format.md). Only the order of the points inside a level is lost:
/// they come back in 16 interleaved passes over the level's Morton order (drawing_order.h), so that a prefix which ends
/// inside a level is even too. Throws Error for a node of more than kMaxNodePoints points or 4 GB.
EncodedNode encodeNode(const NodePoints& points, const StoreInfo& info, EncodeScratch& scratch);
EncodedNode encodeNode(const NodePoints& points, const StoreInfo& info);

/// The number of leading payload bytes that drawing at `precision` needs.
std::uint32_t drawBytes(const NodeRecord& record, Precision precision);

/// Ends of the planes that drawing uses, as offsets in the payload; 0 for planes that the node does not have.
struct PlaneEnds {
  std::uint32_t position[3] = {0, 0, 0};
  std::uint32_t colour = 0, intensity = 0, classification = 0, returnNumber = 0, normal = 0;
  std::uint32_t whole = 0;  ///< end of the last plane that was in memory whole, and so were all planes before it
};

/// Working memory of decodeForDrawing(), worth keeping from node to node. It serves one thread at a time.
class DecodeScratch {
 public:
  DecodeScratch();
  ~DecodeScratch();
  DecodeScratch(DecodeScratch&&) noexcept;
  struct Buffers;
  Buffers& buffers() { return *buffers_; }

 private:
  std::unique_ptr<Buffers> buffers_;
};

/// The bytes of a payload that are in memory: its head, and the range that starts at `from`.
struct PayloadPart {
  std::span<const std::byte> head;  ///< begins with the payload's head
  std::uint32_t from = 0;           ///< 0, or PlaneEnds::whole of the part before
  std::span<const std::byte> bytes;
};

/// Decodes the planes that drawing uses and that lie whole in `part`, whose length was chosen by the caller. A part
/// that starts at 0 replaces `out`, whose memory is used again, and leaves it without points when it ends too early for
/// any; a later part adds its planes to those of the parts before. No byte is trusted: throws Error (`points.bin: node
/// r042: block checksum mismatch`) for everything that does not fit, and leaves `out` in no useful state.
PlaneEnds decodeForDrawing(const NodeRecord& record, const StoreInfo& info, const PayloadPart& part,
                           DecodeScratch& scratch, NodeData& out);

/// Does the same with the first drawBytes(record, precision) bytes of a payload, or more. `out` gets all the position
/// planes of the precision, filled with 0 where the node stores nothing. Throws Error when one of them is not in
/// memory.
void decodeForDrawing(const NodeRecord& record, const StoreInfo& info, std::span<const std::byte> payload,
                      Precision precision, NodeData& out);

/// Decodes a whole payload. The points are in drawing order, and drawColours are empty. Throws Error as above.
NodePoints decodeAll(const NodeRecord& record, const StoreInfo& info, std::span<const std::byte> payload);

/// Read a node from the store's points and decode it.
void readForDrawing(const Store& store, std::uint32_t nodeIndex, Precision precision, NodeData& out);
NodePoints readAll(const Store& store, std::uint32_t nodeIndex);

}  // namespace strata
