#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/node_data.h"
#include "io/store/store.h"

namespace strata {

/// The points of one node in full: what the converter writes and an export reads back.
struct NodePoints {
  std::vector<std::int64_t> grid[3];  ///< integers of StoreGrid
  std::vector<std::byte> attributes;  ///< records of StoreInfo::layout
  /// Points up to and including each level of the level order, the last one all. The codec sorts inside a level, since
  /// sorted points take fewer bytes. Empty: the points keep the order they have.
  std::vector<std::uint32_t> levels;
  /// R | G << 8 | B << 16 of what is drawn where that is not the point's own colour. Empty: its own.
  std::vector<std::uint32_t> drawColours;

  std::size_t count() const { return grid[0].size(); }
};

/// A node's payload and the part of its record that describes it (offset is the writer's to fill in).
struct EncodedNode {
  std::vector<std::byte> payload;
  std::uint32_t headBytes = 0;
  std::uint64_t headChecksum = 0;
  std::uint32_t drawBytes[3] = {0, 0, 0};
};

/// Working memory of encodeNode, worth keeping from node to node. One thread at a time.
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

/// Packs points into planes as docs/format.md says. Lossless but for the order inside a level, which becomes one of 16
/// interleaved passes over the level's Morton order (node_payload.h), so that prefixes inside a level are even too.
EncodedNode encodeNode(const NodePoints& points, const StoreInfo& info, EncodeScratch& scratch);
EncodedNode encodeNode(const NodePoints& points, const StoreInfo& info);

/// How many leading bytes of the payload a drawing at `precision` has to fetch.
std::uint32_t drawBytes(const NodeRecord& record, Precision precision);

/// Where in the payload the planes that drawings look at end; 0 for those that the node does not have.
struct PlaneEnds {
  std::uint32_t position[3] = {0, 0, 0};
  std::uint32_t colour = 0, intensity = 0, classification = 0, returnNumber = 0, normal = 0;
  std::uint32_t whole = 0;  ///< where the last plane ends that has been at hand from its beginning to its end
};

/// Working memory of decodeForDrawing, worth keeping from node to node. One thread at a time.
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

/// Decodes all planes for drawing that lie whole in `bytes`, which stand in the payload from `from` on, into `out`,
/// which holds what the bytes before them gave. `from` is 0 or PlaneEnds::whole of those before; `head` begins with the
/// payload's head. Where `from` is 0, `out` is replaced (the memory it holds is used again), and left without points
/// when the bytes end too early for any. Trusts nothing: throws Error (`points.bin: node r042: block checksum
/// mismatch`) for anything that does not fit; `out` then holds nothing of use.
PlaneEnds decodeForDrawing(const NodeRecord& record, const StoreInfo& info, std::span<const std::byte> head,
                           std::uint32_t from, std::span<const std::byte> bytes, DecodeScratch& scratch, NodeData& out);

/// The same of a payload's first bytes, drawBytes(record, precision) or more: `out` has as many position planes as the
/// precision asks for, zeros where nothing is stored. Throws too where they are not at hand.
void decodeForDrawing(const NodeRecord& record, const StoreInfo& info, std::span<const std::byte> payload,
                      Precision precision, NodeData& out);

/// Decodes everything, in drawing order and without drawColours. Throws Error as above.
NodePoints decodeAll(const NodeRecord& record, const StoreInfo& info, std::span<const std::byte> payload);

/// Reads from the store's points and decodes.
void readForDrawing(const Store& store, std::uint32_t nodeIndex, Precision precision, NodeData& out);
NodePoints readAll(const Store& store, std::uint32_t nodeIndex);

}  // namespace strata
