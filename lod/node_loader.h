#pragma once
#include <cstddef>
#include <cstdint>
#include <stop_token>
#include <vector>

#include "core/node_data.h"
#include "io/store.h"

namespace strata {

/// The least precision that draws as well as `wanted`: planes that hold nothing for this node are not asked for.
Precision usefulPrecision(const NodeRecord& record, Precision wanted);

/// The most bytes of memory a node takes when loaded by NodeLoader, at any precision.
std::uint64_t nodeBytesBound(const NodeRecord& record, const StoreInfo& info);

/// Reads and decodes nodes. One thread an object; keeps its buffer for the next node.
class NodeLoader {
 public:
  /// Largest single read, so that a loader sees that it is to stop; above nearly all payloads, because each read of a
  /// slow source costs its latency.
  static constexpr std::size_t kMaxReadBytes = std::size_t{1} << 20;

  /// `store` has to outlive the loader.
  explicit NodeLoader(const Store& store) : store_(store) {}

  /// Reads exactly drawBytes(record, precision) bytes and decodes them into `out`, using its memory again.
  /// False when stopped half-way. Throws Error when the bytes cannot be read or are not those that were written.
  bool load(std::uint32_t node, Precision precision, std::stop_token stop, NodeData& out);

 private:
  const Store& store_;
  std::vector<std::byte> payload_;
};

}  // namespace strata
