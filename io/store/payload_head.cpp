#include "io/store/payload_head.h"

#include <cstring>
#include <string>

#include "core/error.h"
#include "io/file/checksum.h"

namespace strata {
namespace {

[[noreturn]] void fail(const NodeRecord& record, const std::string& what) {
  throw Error("points.bin", "node " + NodeKey{record.key}.text() + ": " + what);
}

void check(const NodeRecord& record, const ParsedHead& parsed) {
  const PayloadHead& head = parsed.head;
  if (head.pointCount != record.pointCount)
    fail(record, "point count does not match, found " + std::to_string(head.pointCount) + " (expected " +
                     std::to_string(record.pointCount) + ")");
  if (head.pointCount > kMaxNodePoints) fail(record, "too many points");
  for (int axis = 0; axis < 3; ++axis)
    if (head.bits[axis] > kMaxCoordinateBits || head.start[axis] > kOctreeLevels)
      fail(record, "bounds with too many bits");
  std::uint32_t before = 0;
  for (const std::uint32_t end : parsed.levelEnds) {
    if (end <= before || end > head.pointCount) fail(record, "levels do not ascend");
    before = end;
  }
  if (!parsed.levelEnds.empty() && before != head.pointCount) fail(record, "levels do not end at the point count");
}

}  // namespace

ParsedHead parseHead(const NodeRecord& record, std::span<const std::byte> payload) {
  ParsedHead parsed;
  PayloadHead& head = parsed.head;
  if (payload.size() < record.headBytes || record.headBytes < sizeof head) fail(record, "truncated payload head");
  if (checksum(payload.first(record.headBytes)) != record.headChecksum) fail(record, "payload head checksum mismatch");
  std::memcpy(&head, payload.data(), sizeof head);
  const std::size_t expected =
      sizeof head + head.levelCount * sizeof(std::uint32_t) + head.planeCount * sizeof(PayloadPlane);
  if (expected != record.headBytes) fail(record, "payload head has the wrong size");
  parsed.levelEnds.resize(head.levelCount);
  parsed.planes.resize(head.planeCount);
  const std::byte* from = payload.data() + sizeof head;
  if (head.levelCount > 0) std::memcpy(parsed.levelEnds.data(), from, head.levelCount * sizeof(std::uint32_t));
  from += head.levelCount * sizeof(std::uint32_t);
  if (head.planeCount > 0) std::memcpy(parsed.planes.data(), from, head.planeCount * sizeof(PayloadPlane));
  check(record, parsed);
  return parsed;
}

}  // namespace strata
