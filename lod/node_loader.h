#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <stop_token>
#include <utility>

#include "io/store/store.h"
#include "lod/load_queue.h"
#include "lod/node_reader.h"
#include "lod/streamed_node.h"

namespace strata {

/// The least precision that draws as well as `wanted`: planes that hold nothing for this node are not asked for.
Precision usefulPrecision(const NodeRecord& record, Precision wanted);

/// The most bytes of memory a point of the store's nodes takes.
std::uint64_t bytesAPointBound(const StoreInfo& info);
/// The most bytes of memory a node takes when loaded by NodeLoader, at any precision.
std::uint64_t nodeBytesBound(const NodeRecord& record, std::uint64_t bytesAPoint);
std::uint64_t nodeBytesBound(const NodeRecord& record, const StoreInfo& info);

/// Reads and decodes nodes. One loader thread uses it; it keeps its buffers for the next node.
class NodeLoader {
 public:
  /// Largest single read that brings more than one node: each read of a slow source costs its latency, and a stopped
  /// loader may have to wait for one.
  static constexpr std::uint64_t kMaxReadBytes = std::uint64_t{1} << 20;

  explicit NodeLoader(std::shared_ptr<const Store> store) : store_(std::move(store)), reader_(store_) {}

  /// Reads the bytes of all requests at once (by ascending offset, as LoadQueue::pop() gives them) and says how many
  /// those were; 0 when stopped. Throws what the source threw.
  std::uint64_t read(std::span<const LoadRequest> requests, std::stop_token stop);

  /// Decodes one of the nodes that were read, using the memory of `out` again. `before` is the node as it has been so
  /// far, where the request is for the rest of it; else null. False when the request was for too few bytes to have any
  /// points. Throws Error when its bytes are not those that were written.
  bool decode(const LoadRequest& request, const StreamedNode* before, bool withOccluders, StreamedNode& out);

 private:
  const std::shared_ptr<const Store> store_;
  NodeReader reader_;
  DecodeScratch scratch_;
  std::span<const std::byte> bytes_;
  std::uint64_t offset_ = 0;  ///< of bytes_ in points.bin
};

}  // namespace strata
