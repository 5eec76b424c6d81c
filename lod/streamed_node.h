#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/node_data.h"
#include "io/store/node_codec.h"
#include "lod/occluders.h"

namespace strata {

/// A node as the streamer keeps it: its decoded points, its occluders, and what it takes to read the rest of it later.
struct StreamedNode : NodeData {
  OccluderSet occluding;
  /// The head of the payload, without which later planes cannot be decoded, and behind it the bytes read so far of a
  /// plane that has not been read whole.
  std::vector<std::byte> head;
  std::uint32_t leadingBytes = 0;  ///< bytes of the payload that have been read and need not be read again
  PlaneEnds ends;                  ///< where each plane of the payload ends

  /// Bytes of memory held, the node itself included.
  std::uint64_t memoryBytes() const {
    return bytes() + head.capacity() + occluding.occluders.capacity() * sizeof(Occluder);
  }
};

}  // namespace strata
