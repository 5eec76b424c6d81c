#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "io/store/node_codec.h"
#include "io/store/store.h"
#include "lod/load_queue.h"
#include "lod/streamed_node.h"

namespace strata {

/// The least precision that draws as well as `wanted`: planes that are empty for this node are left out.
Precision usefulPrecision(const NodeRecord& record, Precision wanted);

/// The most bytes of memory that a point of the store's nodes takes.
std::uint64_t bytesAPointBound(const StoreInfo& info);
/// The most bytes of memory that a node takes once NodeDecoder has decoded it, at any precision.
std::uint64_t nodeBytesBound(const NodeRecord& record, std::uint64_t bytesAPoint);
std::uint64_t nodeBytesBound(const NodeRecord& record, const StoreInfo& info);

enum class DecodeResult : std::uint8_t { decoded, tooFewBytes };

/// Turns bytes of points.bin into nodes with occluders. One loader thread uses it; it keeps its memory for the next
/// node.
class NodeDecoder {
 public:
  explicit NodeDecoder(std::shared_ptr<const Store> store) : store_(std::move(store)) {}

  /// Decodes the bytes that `request` asked for into `out`, whose memory is used again. `before` is the node as it has
  /// been so far when the request is for the rest of it, else null. With tooFewBytes, the bytes hold no points and
  /// `out` is of no use. Throws Error when the bytes are not those that were written.
  DecodeResult decode(const LoadRequest& request, std::span<const std::byte> bytes, const StreamedNode* before,
                      bool withOccluders, StreamedNode& out);

 private:
  std::span<const std::byte> continueFrom(const StreamedNode& before, const NodeRecord& record,
                                          std::span<const std::byte> bytes, StreamedNode& out);

  const std::shared_ptr<const Store> store_;

  // Used by the loader thread.
  DecodeScratch scratch_;
  std::vector<std::byte> joined_;  ///< the beginning of a plane from one read, and its end from the next
};

}  // namespace strata
