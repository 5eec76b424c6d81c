// libFuzzer: no bytes may crash the payload decoder. Their checksums are corrected first, so that the fuzzer gets past
// them.
#include <algorithm>
#include <cstring>

#include "core/error.h"
#include "io/store/node_codec.h"
#include "tests/support/sign_payload.h"

namespace {

strata::StoreInfo storeInfo() {
  strata::StoreInfo info;
  info.layout = strata::PointLayout({{"rgb", strata::ScalarType::u16, 3, "", 1.0, 0.0},
                                     {"intensity", strata::ScalarType::u16, 1, "", 1.0, 0.0},
                                     {"classification", strata::ScalarType::u8, 1, "", 1.0, 0.0},
                                     {"gps_time", strata::ScalarType::f64, 1, "", 1.0, 0.0}});
  info.cubeBits = 30;
  return info;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const strata::StoreInfo info = storeInfo();
  if (size < 4) return 0;
  std::uint16_t points, headBytes;
  std::memcpy(&points, data, 2);
  std::memcpy(&headBytes, data + 2, 2);
  std::vector<std::byte> payload(size - 4);
  if (!payload.empty()) std::memcpy(payload.data(), data + 4, payload.size());
  headBytes = static_cast<std::uint16_t>(std::min<std::size_t>(headBytes, payload.size()));
  strata::test::signPayload(payload, headBytes);
  strata::NodeRecord record{};
  record.key = 1;
  record.pointCount = points;
  record.headBytes = headBytes;
  record.headChecksum = strata::checksum(std::span(payload).first(headBytes));
  record.payloadBytes = static_cast<std::uint32_t>(payload.size());
  const std::uint32_t half = static_cast<std::uint32_t>(payload.size() / 2);
  for (const std::uint32_t bytes : {half, record.payloadBytes}) {
    strata::NodeData drawn;
    strata::DecodeScratch scratch;
    try {
      const std::span<const std::byte> all(payload);
      const strata::PlaneEnds ends = strata::decodeForDrawing(record, info, {all, 0, all.first(bytes)}, scratch, drawn);
      if (!drawn.position[0].empty() && ends.whole <= bytes)
        strata::decodeForDrawing(record, info, {all, ends.whole, all.subspan(ends.whole)}, scratch, drawn);
    } catch (const strata::Error&) {
    }
  }
  try {
    strata::decodeAll(record, info, payload);
  } catch (const strata::Error&) {
  }
  return 0;
}
