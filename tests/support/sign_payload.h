#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "io/file/checksum.h"
#include "io/store/node_payload.h"

namespace strata::test {

/// Corrects the checksums of damaged planes, so that the damage reaches the decoders.
inline void signPayload(std::vector<std::byte>& payload, std::size_t headBytes) {
  PayloadHead head;
  if (headBytes < sizeof head) return;
  std::memcpy(&head, payload.data(), sizeof head);
  std::size_t at = sizeof head + head.levelCount * sizeof(std::uint32_t);
  std::size_t body = headBytes;
  for (int p = 0; p < head.planeCount && at + sizeof(PayloadPlane) <= headBytes; ++p) {
    PayloadPlane plane;
    std::memcpy(&plane, payload.data() + at, sizeof plane);
    if (body + plane.storedBytes > payload.size()) return;
    plane.checksum = checksum(std::span(payload).subspan(body, plane.storedBytes));
    std::memcpy(payload.data() + at, &plane, sizeof plane);
    body += plane.storedBytes;
    at += sizeof plane;
  }
}

}  // namespace strata::test
